// Overlaps that were measured twice, against comparing each with each.
#include "contact/repeated.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace selvage::contact {
namespace {

// Of some pairs of yarns, in a strip as long as there are many; every other one is there twice, nearly.
std::vector<Contact> overlaps(std::size_t count, std::size_t pairs) {
  std::mt19937 random(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  std::vector<Contact> list;
  while (list.size() < count) {
    Contact contact;
    contact.a = random() % pairs;
    contact.b = pairs;
    contact.gap = -between(0.9, 1.1) * 0.01;
    contact.at = {between(0, 0.01 * static_cast<double>(count)), between(0, 0.02), between(0, 0.02)};
    contact.direction = Vec3::UnitZ();
    list.push_back(contact);
    contact.gap *= 0.99 + 0.01 * between(0, 1);
    contact.at += Vec3(between(-0.006, 0.006), 0, 0);
    contact.direction = Vec3(between(-0.6, 0.6), 0, 1).normalized();
    list.push_back(contact);
  }
  Contact far;  // no overlap
  far.gap = 0.01;
  list.push_back(far);
  list.push_back(far);
  std::stable_sort(list.begin(), list.end(),
                   [](const Contact& x, const Contact& y) { return x.gap < y.gap; });
  return list;
}

std::vector<Contact> compared_each_with_each(const std::vector<Contact>& list) {
  std::vector<Contact> kept;
  for (const Contact& contact : list)
    if (std::none_of(kept.begin(), kept.end(), [&](const Contact& k) {
          return contact.is_overlap() && k.a == contact.a && k.b == contact.b &&
                 contact.depth() > 0.98 * k.depth() && (k.at - contact.at).norm() < 0.5 * contact.depth() &&
                 k.direction.dot(contact.direction) > 0.9;
        }))
      kept.push_back(contact);
  return kept;
}

TEST(Repeated, AreThoseOfComparingEachWithEach) {
  for (const std::size_t pairs : {1U, 5U}) {
    std::vector<Contact> list = overlaps(3000, pairs);
    const std::vector<Contact> wanted = compared_each_with_each(list);
    EXPECT_LT(wanted.size(), 2900U);
    EXPECT_GT(wanted.size(), 1500U);
    drop_repeated(list);
    ASSERT_EQ(list.size(), wanted.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      EXPECT_EQ(list[i].at, wanted[i].at);
      EXPECT_EQ(list[i].gap, wanted[i].gap);
    }
  }
}

TEST(Repeated, AreFoundInLinearWork) {
  for (const std::size_t count : {1000U, 16000U, 128000U}) {
    std::vector<Contact> list = overlaps(count, 1);
    EXPECT_LT(drop_repeated(list), 10 * count);
  }
}

}  // namespace
}  // namespace selvage::contact
