#include "pipeline/thumbnails.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <map>

#include "core/process.h"
#include "core/progress.h"
#include "core/readable.h"
#include "core/words.h"
#include "pipeline/batch.h"
#include "pipeline/job.h"
#include "pipeline/limits.h"
#include "pipeline/parts.h"
#include "pipeline/view.h"

namespace selvage::pipeline {

namespace {

namespace fs = std::filesystem;

// Where no --timeout says otherwise: one picture of many is not worth more.
constexpr double seconds_a_picture = 60;

namespace thumbnail_packet {
constexpr char picture = 't', note = 'n';
}

bool is_file(const std::string& path) {
  std::error_code failure;
  return fs::is_regular_file(path, failure);
}

// A name as Input::name() makes it; nothing where no such file is there.
std::optional<Input> input_of(const std::string& name) {
  Input input{name, {}};
  if (is_file(name)) return input;
  const std::size_t mark = name.rfind('?');
  if (mark == std::string::npos || !is_file(name.substr(0, mark))) return std::nullopt;
  input.path = name.substr(0, mark);
  for (const std::string_view setting : split(std::string_view(name).substr(mark + 1), '&')) {
    const std::size_t equals = setting.find('=');
    if (equals == setting.npos) return std::nullopt;
    input.settings.push_back(
        {std::string(setting.substr(0, equals)), std::string(setting.substr(equals + 1))});
  }
  return input;
}

// As of a `view` without options.
Options viewing(const Options& options) {
  Options made = options;
  made.command = Command::view;
  made.picture_width = thumbnail_width;
  made.picture_height = thumbnail_height;
  made.background = {255, 255, 255};
  if (made.timeout == 0) made.timeout = seconds_a_picture;
  return made;
}

// In a process of its own: what it sends is a picture or a note, and messages.
void send_picture(Job& job, const std::string& digest) {
  if (!digest.empty())
    if (const Result<std::string> now = digest_of(job.input.path); !now || *now != digest)
      return job.channel().send(thumbnail_packet::note, "the file has changed since the report");
  const std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric) return;
  const std::optional<fabric::YarnBuilder> builder = job.builder(*fabric);
  if (!builder) return;
  if (builder->count() == 0) return job.channel().send(thumbnail_packet::note, "it has no yarns");
  const std::optional<std::vector<yarn::Body>> bodies = job.build_all(*builder);
  if (!bodies || job.has_failed()) return;
  const Result<std::string> drawn = draw(job, *bodies, picture_options(job, *bodies));
  if (!drawn) return job.say(drawn.error());
  job.channel().send(thumbnail_packet::picture, *drawn);
}

// The text of a message of a job, without its place and what follows it.
std::string_view reason_in(std::string_view message) {
  constexpr std::string_view mark = "error: ";
  const std::size_t at = message.find(mark);
  if (at == message.npos) return {};
  return message.substr(at + mark.size(), message.find('\n', at) - at - mark.size());
}

// One picture, of the rows of one input as it was at one time: reports that are joined name it several times.
struct Drawing {
  Input input;
  std::string digest;  // empty: not known
  std::vector<std::size_t> rows;
  Thumbnail made;
};

// Of rows without one `thumbnails` say why.
std::vector<Drawing> drawings_of(const std::vector<const Json*>& entries,
                                 std::vector<Thumbnail>& thumbnails) {
  std::vector<Drawing> drawings;
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  std::size_t rows = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const std::string path = text_at(*entries[k], "path"), digest = text_at(*entries[k], "sha256");
    std::optional<Input> input = input_of(path);
    if (rows == most_thumbnails) {
      thumbnails[k].note = fmt::format("only the first {} have pictures", most_thumbnails);
    } else if (!input) {
      thumbnails[k].note = "the file is not there";
    } else {
      ++rows;
      const auto [drawing, is_new] = known.emplace(std::pair(path, digest), drawings.size());
      if (is_new) drawings.push_back({std::move(*input), digest, {}, {}});
      drawings[drawing->second].rows.push_back(k);
    }
  }
  return drawings;
}

// Each row its picture, as long as the page does not get too large.
void hand_out(const std::vector<Drawing>& drawings, std::vector<Thumbnail>& thumbnails) {
  std::vector<const Thumbnail*> of_row(thumbnails.size());
  for (const Drawing& drawing : drawings)
    for (const std::size_t row : drawing.rows) of_row[row] = &drawing.made;
  std::size_t bytes = 0;
  for (std::size_t k = 0; k < thumbnails.size(); ++k) {
    if (of_row[k] == nullptr) continue;
    bytes += of_row[k]->png.size();
    if (bytes <= most_thumbnail_bytes)
      thumbnails[k] = *of_row[k];
    else
      thumbnails[k].note = fmt::format("a page has {} MB of pictures at most", most_thumbnail_bytes >> 20U);
  }
}

}  // namespace

Result<std::vector<Thumbnail>> thumbnails_of(const Options& options,
                                             const std::vector<const Json*>& entries) {
  std::vector<Thumbnail> thumbnails(entries.size());
  std::vector<Drawing> drawings = drawings_of(entries, thumbnails);
  Options view = viewing(options);
  share_memory(view, std::min(available_cores(view), std::max<std::size_t>(1, drawings.size())));
  ProgressDisplay progress(view.progress_json                 ? ProgressForm::json
                           : !view.quiet && !view.no_progress ? ProgressForm::shown
                                                              : ProgressForm::none,
                           drawings.size());
  std::size_t ended = 0;
  JobPool pool;
  pool.count = drawings.size();
  pool.at_once = available_cores(view);
  pool.seconds = view.timeout;
  pool.mebibytes = view.memory;
  pool.run = [&](std::size_t index, const Channel& channel) {
    const Drawing& drawing = drawings[index];
    const std::vector<PlannedOutput> none;
    Job job(view, drawing.input, none, channel);
    Status done = contain_job(view, std::array{drawing.input.path}, {});
    if (done) done = guarded(view, [&] { send_picture(job, drawing.digest); });
    if (!done) job.say(done.error());
    return 0;
  };
  pool.received = [&](std::size_t index, char kind, std::string_view bytes) {
    constexpr std::size_t longest_note = 500;  // characters
    Thumbnail& made = drawings[index].made;
    if (kind == thumbnail_packet::picture && bytes.size() <= most_thumbnail_bytes) made.png = bytes;
    if (kind == thumbnail_packet::note) made.note = shortened(bytes, longest_note);
    // Messages have words of the file: they are for who has seen it, as its SHA-256 shows.
    if (kind == packet::message && made.note.empty() && !drawings[index].digest.empty())
      made.note = shortened(reason_in(bytes), longest_note);
  };
  pool.finished = [&](std::size_t index, const JobEnd& end) {
    Thumbnail& made = drawings[index].made;
    const std::string reason = describe(end, view.timeout, memory_limit(view));
    if (!reason.empty()) made = {{}, "drawing it " + reason};
    if (made.png.empty() && made.note.empty()) made.note = "it could not be drawn";
    progress.set(++ended, 0, "drawing");
  };
  pool.interrupted = [](std::size_t) {};
  pool.tick = [&] { return progress.tick(); };
  const Result<PoolEnd> end = run_jobs(pool);
  progress.finish();
  if (!end) return end.error();
  if (*end == PoolEnd::interrupted) return error(Kind::interrupted, "interrupted; nothing was written");
  hand_out(drawings, thumbnails);
  return thumbnails;
}

}  // namespace selvage::pipeline
