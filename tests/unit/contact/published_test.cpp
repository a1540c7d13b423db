// Overlaps that papers state, and the smallest amplitude at which a sine weave is free.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <random>

#include "built.h"
#include "contact/contact.h"
#include "formats/registry.h"
#include "unit/contact/oracle.h"

namespace selvage::contact {
namespace {

std::vector<yarn::Body> bodies_of(const std::string& text, bool as_published) {
  Diagnostics diagnostics;
  const std::optional<fabric::Fabric> fabric =
      formats::txt::descriptor().read_fabric(Source::from_memory(text, "cloth.txt"), diagnostics);
  if (!fabric) {
    ADD_FAILURE() << to_string(*diagnostics.first_error());
    return {};
  }
  fabric::BuildOptions options;
  options.as_published = as_published;
  return test::built(*fabric, options);
}

Contacts contacts_of(const std::vector<yarn::Body>& bodies, int threads = 1) {
  ContactOptions options;
  options.threads = threads;
  Result<Contacts> found = find_contacts(bodies, options);
  EXPECT_TRUE(found.ok());
  return found ? std::move(*found) : Contacts{};
}

// The published jersey: by how many r neighbouring loops of a course overlap (a yarn with itself), and loops
// of neighbouring courses.
TEST(Published, JerseyOverlapsAsStated) {
  struct Case {
    const char* method;
    double itself, neighbour;
  };
  for (const Case& c :
       {Case{"chord", 0.099, 0.0499}, Case{"centripetal", 0.135, 0.0644}, Case{"uniform", 0.177, 0.0805}}) {
    SCOPED_TRACE(c.method);
    const std::vector<yarn::Body> bodies =
        bodies_of(fmt::format("fabric 1\nunits mm\nthread t\n  section circle 2\nend\n"
                              "knit jersey\n  thread t\n  courses 4\n  wales 5\n  method {}\nend\n",
                              c.method),
                  true);
    ASSERT_EQ(bodies.size(), 4U);
    const Contacts found = contacts_of(bodies);
    double itself = 0.0, neighbour = 0.0;
    int selves = 0, neighbours = 0;
    for (const Contact& contact : found.list) {
      ASSERT_TRUE(contact.is_overlap());
      if (contact.a == contact.b) {
        ++selves;
        itself = std::max(itself, contact.depth());
      } else {
        EXPECT_EQ(contact.b, contact.a + 1);
        ++neighbours;
        neighbour = std::max(neighbour, -contact.spots.front().gap);
      }
    }
    EXPECT_NEAR(itself, c.itself, 0.002);
    EXPECT_NEAR(neighbour, c.neighbour, 0.002);
    // Heads and feet of neighbouring loops touch in turn; two legs a loop stand in each head above.
    EXPECT_EQ(selves, 4 * 9);
    EXPECT_EQ(neighbours, 3 * 5 * 2);
  }
}

// Each section of each yarn by its own way, so that no place is any more like another one.
void shake(std::vector<yarn::Body>& bodies, double by) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> way(-by, by);
  for (yarn::Body& body : bodies) {
    body.shape = 0;
    nurbs::Surface& s = body.surface;
    for (int j = 0; j < s.count_v; ++j) {
      const Vec3 shift(way(random), way(random), way(random));
      for (int i = 0; i < s.count_u; ++i) s.point(i, j) += shift;
    }
  }
}

// The places of contacts are points of the surfaces.
void expect_sites(const Contact& contact, const std::vector<yarn::Body>& bodies, double size) {
  for (const Minimum& spot : contact.spots) {
    if (spot.site_a) {
      const Vec3 there = nurbs::evaluate(bodies[contact.a].surface, spot.site_a->x(), spot.site_a->y());
      EXPECT_LT((there - spot.on_a).norm(), 1e-6 * size);
    }
    if (spot.site_b) {
      const Vec3 there = nurbs::evaluate(bodies[contact.b].surface, spot.site_b->x(), spot.site_b->y());
      EXPECT_LT((there - spot.on_b).norm(), 1e-6 * size);
    }
  }
}

// What is known of places that are alike finds what looking at every place finds: jersey, a twill, two wefts
// of unlike threads, and wefts that run through the warps (measured as wholes).
TEST(Published, ContactsOfPlacesThatAreAlikeAreThoseThatAreFoundOneByOne) {
  const std::string head =
      "fabric 1\nunits mm\nthread t\n  section ellipse 0.8 0.2\nend\nthread f\n  section circle 0.3\nend\n";
  const std::string weave =
      head +
      "weave\n  warp t 8 pitch 0.7\n  weft f 7 pitch 0.9\n  draft twill 2/2\n  profile sine 0.22\nend\n";
  const std::string through =
      head + "weave\n  warp f 1 pitch 1.1\n  weft f 3 pitch 0.9\n  draft plain\n  profile sine 0.02\nend\n";
  const std::string knit =
      "fabric 1\nunits mm\nthread t\n  section circle 2\nend\n"
      "knit jersey\n  thread t\n  courses 5\n  wales 12\nend\n";
  for (const std::string& text : {knit, weave, through}) {
    SCOPED_TRACE(text);
    std::vector<yarn::Body> bodies = bodies_of(text, true);
    const std::vector<std::size_t> first = yarn::first_of_shape(bodies);
    std::size_t copies = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) copies += first[i] != i ? 1 : 0;
    EXPECT_GE(copies, 1U);
    const Contacts known = contacts_of(bodies, 2);
    double size = 0.0;
    for (const yarn::Body& body : bodies) size = std::max(size, yarn::bounds(body).diagonal().norm());
    for (const Contact& contact : known.list) expect_sites(contact, bodies, size);
    shake(bodies, 2e-7);
    const Contacts each = contacts_of(bodies);
    ASSERT_EQ(known.list.size(), each.list.size());
    EXPECT_GE(each.list.size(), 2U);
    // Lists are sorted by depths, which agree up to rounding: each is looked for among the others'.
    for (const Contact& contact : each.list) {
      const bool is_there = std::any_of(known.list.begin(), known.list.end(), [&](const Contact& other) {
        return other.a == contact.a && other.b == contact.b && (other.at - contact.at).norm() < 1e-3 * size &&
               std::abs(other.gap - contact.gap) < 5e-3 * std::abs(contact.gap) + 8e-6 &&
               other.spots.size() == contact.spots.size();
      });
      EXPECT_TRUE(is_there) << contact.a << ' ' << contact.b << ' ' << contact.gap;
    }
  }
}

// 4 x 4 yarns with sections of 0.8 x 0.2, pitch 1: the waves are whole between the outermost crossings.
std::vector<yarn::Body> sine_weave(double amplitude) {
  return bodies_of(
      fmt::format("fabric 1\nunits mm\ntolerance 0.00002\nthread t\n  section ellipse 0.8 0.2\nend\n"
                  "weave\n  warp t 4 pitch 1\n  weft t 4 pitch 1\n  draft plain\n"
                  "  profile sine {}\nend\n",
                  amplitude),
      true);
}

std::vector<Contact> at_middle_crossing(const Contacts& found) {
  std::vector<Contact> here;
  for (const Contact& contact : found.list)
    if (std::abs(contact.at.x() - 1.5) < 0.5 && std::abs(contact.at.y() - 1.5) < 0.5) here.push_back(contact);
  return here;
}

TEST(Published, SineWeaveOverlapsInFourPlacesACrossing) {
  const std::vector<yarn::Body> bodies = sine_weave(0.1125);
  ASSERT_EQ(bodies.size(), 8U);
  const std::vector<Contact> here = at_middle_crossing(contacts_of(bodies));
  ASSERT_EQ(here.size(), 4U);
  const std::optional<test::FacingPair> sampled = test::sampled_deepest(bodies[1], bodies[5], 0.1, 60, 160);
  ASSERT_TRUE(sampled.has_value());
  for (const Contact& contact : here) {
    ASSERT_TRUE(contact.is_overlap());
    EXPECT_NEAR(contact.depth(), sampled->depth, 0.01 * sampled->depth);
    EXPECT_NEAR(std::abs(contact.at.x() - 1.5), 0.3, 0.02);
    EXPECT_NEAR(std::abs(contact.at.y() - 1.5), 0.3, 0.02);
  }
}

TEST(Published, SineWeaveIsFreeFromAnAmplitudeOn) {
  EXPECT_FALSE(at_middle_crossing(contacts_of(sine_weave(0.1176))).empty());
  EXPECT_TRUE(contacts_of(sine_weave(0.1180)).list.empty());
  EXPECT_TRUE(contacts_of(sine_weave(0.1200)).list.empty());
}

TEST(Published, TheSameWithAnyNumberOfThreads) {
  const std::vector<yarn::Body> bodies = bodies_of(
      "fabric 1\nunits mm\nthread t\n  section circle 2\nend\n"
      "knit jersey\n  thread t\n  courses 4\n  wales 5\nend\n",
      true);
  const Contacts one = contacts_of(bodies, 1), three = contacts_of(bodies, 3);
  ASSERT_EQ(one.list.size(), three.list.size());
  ASSERT_FALSE(one.list.empty());
  for (std::size_t k = 0; k < one.list.size(); ++k) {
    EXPECT_EQ(one.list[k].a, three.list[k].a);
    EXPECT_EQ(one.list[k].b, three.list[k].b);
    EXPECT_EQ(one.list[k].gap, three.list[k].gap);
    EXPECT_EQ(one.list[k].at, three.list[k].at);
    EXPECT_EQ(one.list[k].area, three.list[k].area);
  }
  EXPECT_EQ(one.min_gap, three.min_gap);
}

}  // namespace
}  // namespace selvage::contact
