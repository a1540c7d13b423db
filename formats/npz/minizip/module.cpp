// The minizip library behind formats/npz/archive.h.
#include <minizip/zip.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "core/module.h"
#include "formats/npz/archive.h"

namespace selvage::formats::npz {
namespace {

// Its file: ours, with a place to which it may go back.
struct Stream {
  OutputFile* file;
  std::uint64_t at = 0;
  Status status{};
};

Stream& stream_of(void* opaque) {
  return *static_cast<Stream*>(opaque);
}

void* open(void* opaque, const void* /*name*/, int /*mode*/) {
  return opaque;
}

uLong write(void* opaque, void* /*stream*/, const void* bytes, uLong size) {
  Stream& stream = stream_of(opaque);
  const std::string_view block(static_cast<const char*>(bytes), size);
  if (stream.status.ok())
    stream.status = stream.at == stream.file->size() ? stream.file->write(block)
                                                     : stream.file->write_at(stream.at, block);
  if (!stream.status.ok()) return 0;
  stream.at += size;
  return size;
}

uLong read(void* /*opaque*/, void* /*stream*/, void* /*bytes*/, uLong /*size*/) {
  return 0;
}

ZPOS64_T tell(void* opaque, void* /*stream*/) {
  return stream_of(opaque).at;
}

long seek(void* opaque, void* /*stream*/, ZPOS64_T offset, int origin) {
  Stream& stream = stream_of(opaque);
  const std::uint64_t from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                             : origin == ZLIB_FILEFUNC_SEEK_CUR ? stream.at
                                                                : stream.file->size();
  stream.at = from + offset;
  return 0;
}

int nothing(void* /*opaque*/, void* /*stream*/) {
  return 0;
}

void done(int status) {
  if (status != ZIP_OK) throw std::runtime_error("error " + std::to_string(status));
}

void add(zipFile archive, const Member& member) {
  zip_fileinfo info{};
  info.tmz_date = {0, 0, 0, 1, 0, 1980};  // the first day that there is
  constexpr int level = 1, wants_64_bits = 1, memory_level = 8;
  done(zipOpenNewFileInZip3_64(archive, member.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                               Z_DEFLATED, level, 0, -MAX_WBITS, memory_level, Z_DEFAULT_STRATEGY, nullptr, 0,
                               wants_64_bits));
  for (std::string_view rest : {std::string_view(member.head), member.data})
    while (!rest.empty()) {
      constexpr std::size_t most = std::size_t{1} << 24U;
      const std::string_view block = rest.substr(0, most);
      done(zipWriteInFileInZip(archive, block.data(), static_cast<unsigned>(block.size())));
      rest.remove_prefix(block.size());
    }
  done(zipCloseFileInZip(archive));
}

Status write_all(std::span<const Member> members, OutputFile& output) {
  Stream stream{&output};
  zlib_filefunc64_def functions{open, read, write, tell, seek, nothing, nothing, &stream};
  const zipFile archive = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &functions);
  if (archive == nullptr) return error(Kind::limit, "the archive: " + memory_ended());
  try {
    for (const Member& member : members) add(archive, member);
  } catch (const std::exception& failure) {
    zipClose(archive, nullptr);
    if (!stream.status.ok()) return stream.status;
    return error(Kind::internal, std::string("the archive: ") + failure.what());
  }
  const int closed = zipClose(archive, nullptr);
  if (!stream.status.ok()) return stream.status;
  if (closed != ZIP_OK) return error(Kind::internal, "the archive: error " + std::to_string(closed));
  return {};
}

Status guarded(std::span<const Member> members, OutputFile& output) {
  return guarded_by_module("the archive", [&] { return write_all(members, output); });
}

}  // namespace
}  // namespace selvage::formats::npz

extern "C" __attribute__((visibility("default"))) const void* selvage_minizip() {
  using namespace selvage::formats::npz;
  static const ZipModule table = {&guarded};
  return &table;
}
