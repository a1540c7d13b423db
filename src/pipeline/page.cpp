#include "pipeline/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "construction/sheet.h"
#include "contact/contact.h"
#include "pipeline/instances.h"
#include "pipeline/sheet_report.h"
#include "pipeline/view.h"
#include "view/page/page.h"
#include "view/picture.h"
#include "yarn/finish.h"

namespace selvage::pipeline {

namespace {

namespace page = view::page;

// Of all yarns: with more, they are neither kept to look for contacts nor drawn. 100 MB of coordinates.
constexpr std::size_t most_points = 4'000'000;
// Of all shapes together: with more, the finest degree of detail of each is left out.
constexpr std::size_t most_bytes = 12'000'000;
// Near contacts without --reach: as a share of the thinnest yarn.
constexpr double usual_reach = 0.05;

// The shapes of a page, each with what is finer than fits.
class ShapeList {
 public:
  explicit ShapeList(std::vector<page::Shape>& shapes) : shapes_(shapes) {}

  Result<std::size_t> add(const yarn::Body& body) {
    Result<page::Shape> shape = page::make_shape(body, first_level_);
    if (!shape) return shape.error();
    for (const page::Level& level : shape->levels) bytes_ += level.bytes();
    shapes_.push_back(std::move(*shape));
    while (bytes_ > most_bytes && first_level_ + 1 < page::level_count) drop_finest();
    return shapes_.size() - 1;
  }

 private:
  void drop_finest() {
    for (page::Shape& shape : shapes_) {
      bytes_ -= shape.levels.front().bytes();
      shape.levels.erase(shape.levels.begin());
    }
    ++first_level_;
  }

  std::vector<page::Shape>& shapes_;
  std::size_t bytes_ = 0, first_level_ = 0;
};

// The yarns as the builder makes them. `bodies` are all of them, where they are few enough to be kept.
struct Gathered {
  std::vector<yarn::Body> bodies;
  bool is_kept = true;
  std::size_t points = 0;
};

page::Yarn entry(const yarn::BodyLabel& label, const yarn::Body& body, std::size_t shape,
                 const yarn::RigidMotion& motion) {
  return {label, shape, motion, body.length, body.volume};
}

// Yarns of one shape as the builder knows it; where that is none, each has its own.
bool gather(Job& job, const fabric::YarnBuilder& builder, page::Page& to, Gathered& all) {
  ShapeList shapes(to.shapes);
  std::map<std::uint64_t, std::size_t> known;
  const bool keeps_any = job.options.page_contacts == PageContacts::yes;
  job.for_each_shape(builder, "building yarn", [&](const fabric::YarnBuilder::Shaped& yarn) {
    if (job.has_failed() || !is_shown(job.options, yarn.label)) return;
    all.points += yarn.body->surface.points.size();
    if (all.is_kept && all.points > most_points && !keeps_any) {
      all.is_kept = false;
      all.bodies = {};
    }
    if (all.is_kept) {
      yarn::Body body = *yarn.body;
      static_cast<yarn::BodyLabel&>(body) = yarn.label;
      if (yarn.at != Vec3::Zero()) yarn::move(body, yarn.at, yarn.grid);
      all.bodies.push_back(std::move(body));
    }
    const auto found = yarn.body->shape != 0 ? known.find(yarn.body->shape) : known.end();
    std::size_t shape = 0;
    if (found != known.end()) {
      shape = found->second;
    } else {
      const Result<std::size_t> made = shapes.add(*yarn.body);
      if (!made) return job.say(made.error());
      shape = *made;
      if (yarn.body->shape != 0) known.emplace(yarn.body->shape, shape);
    }
    yarn::RigidMotion motion;
    motion.offset = yarn.at;
    to.yarns.push_back(entry(yarn.label, *yarn.body, shape, motion));
  });
  if (!job.has_failed() && to.yarns.empty()) return job.fail(none_shown(job.options));
  return !job.has_failed();
}

// The same yarns once more, now that all are there: those that are equal up to a motion are one shape.
bool find_copies(Job& job, const std::vector<yarn::Body>& bodies, page::Page& to) {
  InstanceFinder finder(0);
  for (const yarn::Body& body : bodies) finder.count(body);
  to.shapes.clear();
  to.yarns.clear();
  ShapeList shapes(to.shapes);
  std::map<std::size_t, std::size_t> known;
  for (const yarn::Body& body : bodies) {
    const std::optional<formats::Instance> copy = finder.place(body);
    if (copy && known.contains(copy->shape)) {
      to.yarns.push_back(entry(body, body, known.at(copy->shape), copy->motion));
      continue;
    }
    const Result<std::size_t> made = shapes.add(copy ? *copy->body : body);
    if (!made) return job.fail(made.error());
    if (copy) known.emplace(copy->shape, *made);
    to.yarns.push_back(entry(body, body, *made, copy ? copy->motion : yarn::RigidMotion{}));
  }
  return true;
}

Box3 box_of(const page::Page& of) {
  Box3 box;
  for (const page::Yarn& yarn : of.yarns) {
    const page::Shape& shape = of.shapes[yarn.shape];
    for (const Box3& part : shape.boxes)
      for (int corner = 0; corner < 8; ++corner)
        box.extend(yarn.motion(shape.centre + part.corner(static_cast<Box3::CornerType>(corner))));
  }
  return box;
}

bool add_contacts(Job& job, const Gathered& all, page::Page& to) {
  const PageContacts wanted = job.options.page_contacts;
  if (wanted == PageContacts::no) {
    to.contacts_note = "Contacts were not looked for (--contacts no).";
    return true;
  }
  if (!all.is_kept) {
    to.contacts_note =
        "Contacts were not looked for, for the yarns are many; --contacts yes does it, or selvage check.";
    return true;
  }
  double thinnest = to.shapes.front().thickness;
  for (const page::Shape& shape : to.shapes) thinnest = std::min(thinnest, shape.thickness);
  contact::ContactOptions options;
  options.reach = job.options.reach > 0 ? job.options.reach : usual_reach * thinnest;
  options.threads = static_cast<int>(job.threads);
  options.progress = job.progress_of("looking for contacts, place");
  const Result<contact::Contacts> found = contact::find_contacts(all.bodies, options);
  if (!found) return job.fail(found.error());
  page::Contacts& contacts = to.contacts.emplace();
  contacts.reach = options.reach;
  for (const contact::Contact& contact : found->list) {
    auto& list = contact.is_overlap() ? contacts.overlaps : contacts.near;
    ++(contact.is_overlap() ? contacts.overlap_count : contacts.near_count);
    if (list.size() < page::Contacts::most) list.push_back({contact.a, contact.b, contact.gap, contact.at});
  }
  return true;
}

// For browsers without WebGL: small and without shadows.
bool add_picture(Job& job, const std::vector<yarn::Body>& bodies, page::Page& to) {
  view::PictureOptions options = picture_options(job, bodies);
  options.width = std::min(options.width, 960);
  options.height = std::min(options.height, 720);
  options.flat = true;
  Result<std::string> bytes = draw(job, bodies, options);
  if (!bytes) return job.fail(bytes.error());
  to.picture = std::move(*bytes);
  return true;
}

}  // namespace

bool write_page(Job& job, const fabric::Fabric& fabric, const fabric::YarnBuilder& builder,
                OutputFile& file) {
  const Result<std::string> library = page::library();
  if (!library) return job.fail(library.error());
  page::Page made;
  made.name =
      std::filesystem::path(job.input.path == "-" ? "standard input" : job.input.path).filename().string();
  made.title = fabric.title.value_or("");
  made.units = fabric.units;
  Gathered all;
  if (!gather(job, builder, made, all)) return false;
  if (all.is_kept && !find_copies(job, all.bodies, made)) return false;
  made.box = box_of(made);
  made.centre = made.box.center();
  if (!add_contacts(job, all, made)) return false;
  if (all.points <= most_points && !add_picture(job, all.bodies, made)) return false;
  made.sheets =
      sheets_json(fabric::sheets_of(builder, job.build_options(), static_cast<int>(job.threads)).sheets)
          .dump();
  const Status written = page::write(made, *library, file);
  return written.ok() || job.fail(written.error());
}

}  // namespace selvage::pipeline
