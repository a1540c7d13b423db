// `selvage view`: a picture of each input.
#include "pipeline/writing.h"
#include "view/picture.h"

namespace selvage::pipeline {

namespace {

view::PictureOptions picture_options(Job& job) {
  const Options& given = job.options;
  view::PictureOptions options;
  options.width = given.picture_width;
  options.height = given.picture_height;
  options.from = given.from;
  options.background = given.background;
  options.flat = given.flat;
  options.threads = static_cast<int>(job.threads);
  options.progress = job.progress_of("drawing tile");
  return options;
}

Status write_picture(Job& job, const std::vector<yarn::Body>& bodies, OutputFile& file) {
  const Result<view::Picture> picture = view::render(bodies, picture_options(job));
  if (!picture) return picture.error();
  const Result<std::string> bytes = view::png(*picture);
  if (!bytes) return bytes.error();
  return file.write(*bytes);
}

}  // namespace

void view(Job& job) {
  const std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  const std::optional<fabric::YarnBuilder> builder = job.builder(*fabric);
  if (!builder) return;
  if (builder->count() == 0)
    return job.say(error(Kind::unsupported,
                         "there is no yarn to show; garment pieces are drawn by: selvage convert --to svg"));
  const std::optional<std::vector<yarn::Body>> bodies = job.build_all(*builder);
  if (!bodies || job.has_failed()) return;
  for (OpenOutput& output : *outputs)
    if (Status status = write_picture(job, *bodies, output.file); !status.ok())
      return job.say(status.error());
  commit_all(job, *outputs);
}

}  // namespace selvage::pipeline
