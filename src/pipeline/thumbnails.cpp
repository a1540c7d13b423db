#include "pipeline/thumbnails.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "core/process.h"
#include "core/progress.h"
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

}  // namespace

Result<std::vector<Thumbnail>> thumbnails_of(const Options& options,
                                             const std::vector<const Json*>& entries) {
  std::vector<Thumbnail> made(entries.size());
  std::vector<std::pair<std::size_t, Input>> drawn;  // entry, input
  for (std::size_t k = 0; k < entries.size(); ++k) {
    std::optional<Input> input = input_of(text_at(*entries[k], "path"));
    if (drawn.size() == most_thumbnails)
      made[k].note = fmt::format("only the first {} have pictures", most_thumbnails);
    else if (!input)
      made[k].note = "the file is not there";
    else
      drawn.emplace_back(k, std::move(*input));
  }
  Options view = viewing(options);
  share_memory(view, std::min(available_cores(view), std::max<std::size_t>(1, drawn.size())));
  ProgressDisplay progress(view.progress_json                 ? ProgressForm::json
                           : !view.quiet && !view.no_progress ? ProgressForm::shown
                                                              : ProgressForm::none,
                           drawn.size());
  std::size_t ended = 0;
  JobPool pool;
  pool.count = drawn.size();
  pool.at_once = available_cores(view);
  pool.seconds = view.timeout;
  pool.mebibytes = view.memory;
  pool.run = [&](std::size_t index, const Channel& channel) {
    const Json& entry = *entries[drawn[index].first];
    const Input& input = drawn[index].second;
    const std::vector<PlannedOutput> none;
    Job job(view, input, none, channel);
    Status done = contain_job(view, std::array{input.path}, {});
    if (done) done = guarded(view, [&] { send_picture(job, text_at(entry, "sha256")); });
    if (!done) job.say(done.error());
    return 0;
  };
  pool.received = [&](std::size_t index, char kind, std::string_view bytes) {
    Thumbnail& thumbnail = made[drawn[index].first];
    if (kind == thumbnail_packet::picture) thumbnail.png = bytes;
    if (kind == thumbnail_packet::note) thumbnail.note = bytes;
    if (kind == packet::message && thumbnail.note.empty()) thumbnail.note = reason_in(bytes);
  };
  pool.finished = [&](std::size_t index, const JobEnd& end) {
    Thumbnail& thumbnail = made[drawn[index].first];
    const std::string reason = describe(end, time_limit(view), memory_limit(view));
    if (!reason.empty()) thumbnail = {{}, "drawing it " + reason};
    if (thumbnail.png.empty() && thumbnail.note.empty()) thumbnail.note = "it could not be drawn";
    progress.set(++ended, 0, "drawing");
  };
  pool.interrupted = [](std::size_t) {};
  pool.tick = [&] { return progress.tick(); };
  const Result<PoolEnd> end = run_jobs(pool);
  progress.finish();
  if (!end) return end.error();
  if (*end == PoolEnd::interrupted) return error(Kind::interrupted, "interrupted; nothing was written");
  return made;
}

}  // namespace selvage::pipeline
