#include "pipeline/single.h"

#include <fmt/format.h>

#include <cstdio>

#include "core/output.h"
#include "core/process.h"
#include "core/progress.h"
#include "core/standard_output.h"
#include "pipeline/batch.h"
#include "pipeline/limits.h"

namespace selvage::pipeline {

namespace {

Verdict contained_work(const Options& options, const Single& single, const Channel& channel) {
  const auto fail = [&](Message message) {
    message.file = "selvage";
    channel.send(packet::message, to_string(message));
    return Verdict::failed;
  };
  Verdict verdict = Verdict::failed;
  Status whole = guarded(options, [&] {
    const Status contained = contain_job(options, single.inputs, single.outputs);
    verdict = contained ? single.work(channel) : fail(contained.error());
  });
  if (whole) return verdict;
  if (whole.error().kind == Kind::limit) whole.error().text.insert(0, single.what + " ");
  return fail(whole.error());
}

}  // namespace

int run_single(const Options& wanted, const Single& single) {
  Options options = wanted;
  if (Status status = check_sandbox(options.sandbox, this_kernel()); !status) return refuse(status.error());
  share_memory(options, 1);
  NewFolders folders;
  for (const std::filesystem::path& output : single.outputs) folders.expect(output);
  OutputFile::remove_leftovers(single.outputs);  // of earlier runs
  ProgressDisplay progress(!options.quiet && !options.no_progress, 1);
  std::string results;
  int code = 1;
  JobPool pool;
  pool.count = 1;
  pool.seconds = options.timeout;
  pool.mebibytes = options.memory;
  pool.run = [&](std::size_t, const Channel& channel) {
    return static_cast<int>(contained_work(options, single, channel));
  };
  pool.received = [&](std::size_t, char kind, std::string_view bytes) {
    if (kind == packet::result) results += bytes;
    if (kind == packet::progress) progress.set(0, 0, std::string(bytes));
    if (kind != packet::message) return;
    progress.clear();
    std::fprintf(stderr, "%.*s\n", static_cast<int>(bytes.size()), bytes.data());
  };
  pool.finished = [&](std::size_t, const JobEnd& end) {
    progress.clear();
    code = end.how == JobEnd::How::exited ? end.status : 1;
    if (const std::string reason = describe(end, time_limit(options), memory_limit(options)); !reason.empty())
      std::fprintf(stderr, "selvage: error: %s %s\n", single.what.c_str(), reason.c_str());
  };
  pool.tick = [&] { return progress.tick(); };
  const Result<PoolEnd> end = run_jobs(pool);
  OutputFile::remove_leftovers(single.outputs);  // of this one, had it been killed
  if (!end) {
    (void)refuse(end.error());
    return 1;
  }
  if (*end == PoolEnd::interrupted) {
    std::fputs("selvage: interrupted\n", stderr);
    return 130;
  }
  if (const Status printed = write_to_standard_output(results); !printed) {
    std::fprintf(stderr, "%s\n", to_string(printed.error()).c_str());
    return 1;
  }
  return code;
}

}  // namespace selvage::pipeline
