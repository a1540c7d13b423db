#include "core/source.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <thread>

#include "core/text_report.h"
#include "unit/core/scratch_folder.h"

namespace selvage {

TEST(Source, CopiesAFile) {
  const test::ScratchFolder folder;
  const std::string bytes("two\nlines\0and a zero", 20);
  test::put_bytes(folder / "a.txt", bytes);
  Result<Source> source = Source::open(folder / "a.txt");
  ASSERT_TRUE(source.ok());
  EXPECT_EQ(source->bytes(), bytes);
  EXPECT_EQ(source->name(), (folder / "a.txt").string());
}

TEST(Source, ViewsStayValidAcrossMoves) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "a.txt", "copied");
  Result<Source> copied = Source::open(folder / "a.txt");
  ASSERT_TRUE(copied.ok());
  const std::string_view view = copied->bytes();
  const Source moved = std::move(*copied);
  EXPECT_EQ(moved.bytes().data(), view.data());
  EXPECT_EQ(view, "copied");
  Source small = Source::from_memory("abc", "name");
  const std::string_view small_view = small.bytes();
  const Source small_moved = std::move(small);
  EXPECT_EQ(small_moved.bytes().data(), small_view.data());
  EXPECT_EQ(small_view, "abc");
  EXPECT_EQ(small_moved.name(), "name");
}

TEST(Source, WhatBecomesOfTheFileChangesNothing) {
  const test::ScratchFolder folder;
  const std::string bytes(100'000, 'x');
  test::put_bytes(folder / "a.txt", bytes);
  const Result<Source> source = Source::open(folder / "a.txt");
  ASSERT_TRUE(source.ok());
  ASSERT_EQ(::truncate((folder / "a.txt").c_str(), 0), 0);
  EXPECT_EQ(source->bytes(), bytes);  // of a mapped file this would be SIGBUS
}

TEST(Source, AFileThatHasFewerBytesThanItSaysHasChanged) {
  const char* const file = "/sys/devices/system/cpu/online";
  struct stat facts {};
  if (::stat(file, &facts) != 0 || facts.st_size < 100) GTEST_SKIP() << "no such file here";
  const Result<Source> source = Source::open(file);
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.error().kind, Kind::io);
  EXPECT_NE(source.error().text.find("changed while it was read"), std::string::npos);
}

TEST(Source, Bounds) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "a.txt", "12345678");
  EXPECT_TRUE(Source::open(folder / "a.txt", 8).ok());
  const Result<Source> large = Source::open(folder / "a.txt", 7);
  ASSERT_FALSE(large.ok());
  EXPECT_EQ(large.error().kind, Kind::limit);
  const std::string path = folder / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&] { test::put_bytes(path, "12345678"); });
  const Result<Source> pipe = Source::open(path, 7);
  writer.join();
  ASSERT_FALSE(pipe.ok());
  EXPECT_EQ(pipe.error().kind, Kind::limit);
  EXPECT_EQ(read_head(folder / "a.txt", 3).value(), "123");
  EXPECT_EQ(read_head(folder / "a.txt", 99).value(), "12345678");
  EXPECT_FALSE(read_head(path, 3).ok());
}

TEST(Source, QuotesOnlyWhatIsInItsFolder) {
  const test::ScratchFolder folder;
  const std::filesystem::path inner = std::filesystem::path(folder / "in");
  std::filesystem::create_directory(inner);
  test::put_bytes(folder / "secret.txt", "words");
  test::put_bytes((inner / "own.txt").string(), "words");
  std::filesystem::create_symlink("own.txt", inner / "within.txt");
  std::filesystem::create_symlink("../secret.txt", inner / "out.txt");
  const auto message = [](const std::filesystem::path& path) {
    const Result<Source> source = Source::open(path);
    TextReport report(*source);
    report.set_yarn("words");
    report.error(spot_at(*source, {1, 1}), "what is said of a yarn's 'words' is wrong");
    Diagnostics found;
    report.hand_over(found);
    return found.messages().front();
  };
  for (const char* name : {"own.txt", "within.txt"}) {
    EXPECT_EQ(message(inner / name).excerpt, "words");
    EXPECT_EQ(message(inner / name).text, "what is said of a yarn's 'words' is wrong");
  }
  const Message outside = message(inner / "out.txt");
  EXPECT_EQ(to_string(outside),
            (inner / "out.txt").string() + ":1:1: error: what is said of a yarn's '...' is wrong");
}

TEST(Source, EmptyFile) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "empty.txt", "");
  Result<Source> source = Source::open(folder / "empty.txt");
  ASSERT_TRUE(source.ok());
  EXPECT_TRUE(source->bytes().empty());
}

TEST(Source, ReadsAPipeToItsEnd) {
  const test::ScratchFolder folder;
  const std::string path = folder / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::string bytes;
  for (int i = 0; i < 100000; ++i) bytes += std::to_string(i) + "\n";
  std::thread writer([&] { test::put_bytes(path, bytes); });
  Result<Source> source = Source::open(path);
  writer.join();
  ASSERT_TRUE(source.ok());
  EXPECT_EQ(source->bytes(), bytes);
}

TEST(Source, WaitsForAWriterThatIsSlow) {
  const test::ScratchFolder folder;
  const std::string path = folder / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&] {
    ::usleep(300000);  // later than the first look
    const int pipe = ::open(path.c_str(), O_WRONLY);
    ::usleep(300000);  // a writer that has written nothing yet
    EXPECT_EQ(::write(pipe, "abc", 3), 3);
    ::usleep(300000);
    EXPECT_EQ(::write(pipe, "def", 3), 3);
    ::close(pipe);
  });
  const Result<Source> source = Source::open(path);
  writer.join();
  ASSERT_TRUE(source.ok());
  EXPECT_EQ(source->bytes(), "abcdef");
}

TEST(Source, ReadsADescriptorsPipe) {
  std::array<int, 2> ends{};
  for (const std::string_view bytes : {"process substitution", ""}) {
    ASSERT_EQ(::pipe(ends.data()), 0);
    EXPECT_EQ(::write(ends[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    ::close(ends[1]);
    const Result<Source> source = Source::open("/proc/self/fd/" + std::to_string(ends[0]));
    ::close(ends[0]);
    ASSERT_TRUE(source.ok());
    EXPECT_EQ(source->bytes(), bytes);
  }
}

TEST(Source, APipeWithoutAWriterEnds) {
  const test::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const Result<Source> source = Source::open(folder / "pipe");
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.error().kind, Kind::io);
  EXPECT_EQ(source.error().text, "nothing has opened this pipe to write to it within 10 s");
}

TEST(Source, DevicesAreNotRead) {
  for (const char* device : {"/dev/zero", "/dev/null"}) {
    const Result<Source> source = Source::open(device);
    ASSERT_FALSE(source.ok());
    EXPECT_EQ(source.error().file, device);
    EXPECT_EQ(source.error().text, "this is a device, not a file; '-' reads standard input");
  }
}

TEST(Source, ReadsStandardInput) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "in", "from standard input");
  const int saved = ::dup(STDIN_FILENO);
  const int file = ::open((folder / "in").c_str(), O_RDONLY);
  ASSERT_EQ(::dup2(file, STDIN_FILENO), STDIN_FILENO);
  Result<Source> source = Source::open("-");
  if (saved >= 0) ::dup2(saved, STDIN_FILENO);
  ::close(saved);
  ::close(file);
  ASSERT_TRUE(source.ok());
  EXPECT_EQ(source->bytes(), "from standard input");
  EXPECT_EQ(source->name(), "<stdin>");
}

TEST(Source, RefusalsSayWhyAndWhere) {
  const test::ScratchFolder folder;
  const Result<Source> missing = Source::open(folder / "nothing.txt");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().kind, Kind::io);
  EXPECT_EQ(missing.error().file, (folder / "nothing.txt").string());
  EXPECT_NE(missing.error().text.find("No such file"), std::string::npos);
  const Result<Source> directory = Source::open(folder / "");
  ASSERT_FALSE(directory.ok());
  EXPECT_NE(directory.error().text.find("directory"), std::string::npos);
  if (::geteuid() == 0) return;  // root may read everything
  test::put_bytes(folder / "secret.txt", "x");
  ::chmod((folder / "secret.txt").c_str(), 0);
  const Result<Source> secret = Source::open(folder / "secret.txt");
  ASSERT_FALSE(secret.ok());
  EXPECT_NE(secret.error().text.find("denied"), std::string::npos);
}

}  // namespace selvage
