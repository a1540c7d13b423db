#include "formats/iges/writer.h"

#include <fmt/format.h>

#include <utility>

#include "formats/iges/file_writer.h"
#include "formats/iges/options.h"
#include "yarn/cut.h"

namespace selvage::formats::iges {

namespace {

// A yarn that needs so many files is a mistake.
constexpr int most_pieces = 1000;

class SetWriter final : public BodyWriter {
 public:
  SetWriter(OutputFile& output, SurfaceOptions options, Records::Limits limits)
      : options_(std::move(options)), limits_(limits) {
    open(output);
  }

  Status add(const yarn::Body& body) override { return add_item(body, nullptr); }
  Status add_instance(const yarn::Body& body, const Instance& instance) override {
    if (!std::exchange(repeats_, true))
      facts_.messages.push_back(
          warning(Kind::unsupported,
                  "IGES: equal yarns are placed by reference (308, 408); Abaqus/CAE passes "
                  "these by, and shows none of them: for such a reader leave out "
                  "--instances"));
    return add_item(body, &instance);
  }

  Status add_piece(const fabric::PieceShape& piece) override {
    return put_behind_pending([&](FileWriter& file) { return file.add_piece(piece); });
  }
  Status add_part(const cad::Part& part) override {
    return put_behind_pending([&](FileWriter& file) { return file.add_part(part); });
  }
  Status add_curve(const cad::NamedCurve& curve) override {
    return put_behind_pending([&](FileWriter& file) { return file.add_curve(curve); });
  }

  Result<WriteFacts> finish() override;

 private:
  // A file that is whole but for what it says of the set.
  struct Finished {
    OutputFile* output = nullptr;
    Header header;
    std::uint64_t digest = 0;
    EntityCounts entities;
  };

  // Into the present file or, where that is full, into the next one.
  template <class Add>
  Status put(const Add& add) {
    Status status = add(*file_);
    if (status.ok() || status.error().kind != Kind::limit || file_->is_empty() || !options_.next_part)
      return status;
    if (Status opened = open_next(); !opened.ok()) return opened;
    return add(*file_);
  }
  template <class Add>
  Status put_behind_pending(const Add& add) {
    Status status = put_pending();
    return status.ok() ? put(add) : status;
  }
  // Too long even for a file of its own.
  [[nodiscard]] bool is_too_long(const Status& status) const {
    return !status.ok() && status.error().kind == Kind::limit && file_->is_empty();
  }

  Status add_item(const yarn::Body& body, const Instance* instance);
  Status put_pending();
  Status put_yarn(const yarn::Body& body);
  Status put_in_pieces(const yarn::Body& body, const Message& why);
  Status finish_file();
  Status open_next();
  void open(OutputFile& output) {
    output_ = &output;
    file_ = std::make_unique<FileWriter>(output, options_, limits_);
  }
  Status mark_all();

  SurfaceOptions options_;
  Records::Limits limits_;
  OutputFile* output_ = nullptr;  // of the present file
  std::unique_ptr<FileWriter> file_;
  std::vector<FileWriter::Item> pending_;  // of one group
  bool repeats_ = false;
  std::vector<Finished> finished_;
  WriteFacts facts_;
};

Status SetWriter::add_item(const yarn::Body& body, const Instance* instance) {
  if (!pending_.empty() && body.group != pending_.front().body.group)
    if (Status status = put_pending(); !status.ok()) return status;
  if (!body.group.empty()) {
    pending_.push_back({body, instance != nullptr ? std::optional(*instance) : std::nullopt});
    return {};
  }
  if (instance == nullptr) return put_yarn(body);
  Status status = put([&](FileWriter& file) { return file.add_instance(body, *instance); });
  return is_too_long(status) ? put_yarn(body) : status;
}

Status SetWriter::put_pending() {
  if (pending_.empty()) return {};
  Status status = put([this](FileWriter& file) { return file.add_group(pending_); });
  if (is_too_long(status))
    status.error().text += "; a yarn's plies and filaments stay in one file: --detail yarn writes it as one";
  pending_.clear();
  return status;
}

Status SetWriter::put_yarn(const yarn::Body& body) {
  Status status = put([&](FileWriter& file) { return file.add(body); });
  if (!is_too_long(status)) return status;
  if (options_.own.has(option::split_yarns) && options_.next_part) return put_in_pieces(body, status.error());
  status.error().text += ": --split-yarns cuts it into several, and a coarser --tolerance makes it shorter";
  return status;
}

// As few pieces as fit, one file each but for the last.
Status SetWriter::put_in_pieces(const yarn::Body& body, const Message& why) {
  const std::int64_t most = limits_.lines;
  auto count = static_cast<int>(
      std::min<std::int64_t>(std::max<std::int64_t>(file_->lines_of(body) / most, 1) + 1, most_pieces));
  for (; count <= most_pieces; count += 1 + count / 8) {
    Result<std::vector<yarn::Body>> pieces = yarn::cut(body, count, yarn::EndStyle::patch);
    if (!pieces) {
      Message message = why;
      message.text += fmt::format(", and it cannot be cut: {}", pieces.error().text);
      return message;
    }
    bool all_fit = true;
    for (const yarn::Body& piece : *pieces) all_fit = all_fit && file_->lines_of(piece) <= most;
    if (!all_fit) continue;
    Message message = warning(
        Kind::limit, fmt::format("{}: it is cut into {} pieces, {} to {}, each closed by end faces of "
                                 "its own; the section where two meet is the same in both",
                                 why.text, count, pieces->front().name, pieces->back().name));
    message.yarn = body.name;
    message.place = body.place;
    facts_.messages.push_back(std::move(message));
    for (const yarn::Body& piece : *pieces) {
      facts_.messages.insert(facts_.messages.end(), piece.messages.begin(), piece.messages.end());
      if (Status status = put([&](FileWriter& file) { return file.add(piece); }); !status.ok()) return status;
    }
    return {};
  }
  return why;
}

Status SetWriter::finish_file() {
  options_.expected_bodies -= std::min(options_.expected_bodies, file_->bodies());
  Result<WriteFacts> facts = file_->finish();
  if (!facts) return facts.error();
  for (const auto& [type, count] : facts->entities) facts_.entities[type] += count;
  facts_.messages.insert(facts_.messages.end(), facts->messages.begin(), facts->messages.end());
  finished_.push_back({output_, file_->header(), file_->digest(), std::move(facts->entities)});
  file_.reset();
  return {};
}

Status SetWriter::open_next() {
  if (Status status = finish_file(); !status.ok()) return status;
  if (finished_.size() == most_files)
    return error(Kind::limit, fmt::format("the fabric needs more than {} files", most_files));
  Result<OutputFile*> next = options_.next_part(static_cast<int>(finished_.size()) + 1);
  if (!next) return next.error();
  open(**next);
  return {};
}

Status SetWriter::mark_all() {
  std::uint64_t digest = 0;
  for (const Finished& file : finished_) digest = (digest ^ file.digest) * 0x9E3779B97F4A7C15;
  const std::string set = fmt::format("{:08x}", static_cast<std::uint32_t>(digest >> 32U));
  int number = 0;
  for (Finished& file : finished_) {
    file.header.part = PartMark{++number, static_cast<int>(finished_.size()), set};
    if (Status status = file.output->write_at(0, header_text(file.header).bytes); !status.ok()) return status;
    facts_.parts.push_back(std::move(file.entities));
  }
  return {};
}

Result<WriteFacts> SetWriter::finish() {
  Status status = put_pending();
  if (status.ok()) status = finish_file();
  if (status.ok() && finished_.size() > 1) status = mark_all();
  if (!status.ok()) return status.error();
  return std::move(facts_);
}

}  // namespace

Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options,
                                                Records::Limits limits) {
  limits.lines = std::min(limits.lines, options.own.whole(option::lines));
  return std::unique_ptr<BodyWriter>(std::make_unique<SetWriter>(output, options, limits));
}

}  // namespace selvage::formats::iges
