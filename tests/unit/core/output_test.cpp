#include "core/output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "core/temporary.h"
#include "unit/core/scratch_folder.h"

namespace selvage {

namespace {

using Names = std::vector<std::string>;

// Runs `part` in a process of its own, which it kills.
template <class Part>
void in_killed_process(Part part) {
  const pid_t child = ::fork();
  if (child == 0) {
    part();
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
}

void put(const std::filesystem::path& path, std::string_view bytes) {
  Result<OutputFile> file = OutputFile::create(path);
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write(bytes).ok());
  ASSERT_TRUE(file->commit().ok());
}

struct stat facts_of(const std::filesystem::path& path) {
  struct stat facts {};
  EXPECT_EQ(::stat(path.c_str(), &facts), 0);
  return facts;
}

}  // namespace

TEST(OutputFile, IsThereAfterCommitOnly) {
  const test::ScratchFolder folder;
  Result<OutputFile> file = OutputFile::create(folder / "a.igs");
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write("one ").ok());
  ASSERT_TRUE(file->write("two").ok());
  EXPECT_EQ(file->size(), 7U);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.igs"));
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "one two");
  EXPECT_EQ(folder.names(), Names{"a.igs"});
}

TEST(OutputFile, ReplacesAnExistingFile) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "a.igs", "old, and longer");
  Result<OutputFile> file = OutputFile::create(folder / "a.igs");
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write("new").ok());
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "old, and longer");
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "new");
  EXPECT_EQ(folder.names(), Names{"a.igs"});
}

TEST(OutputFile, WithoutCommitNothingIsLeft) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "old.igs", "old");
  for (const char* name : {"old.igs", "new.igs"}) {
    Result<OutputFile> file = OutputFile::create(folder / name);
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->write("partial").ok());
  }
  EXPECT_EQ(folder.names(), Names{"old.igs"});
  EXPECT_EQ(test::bytes_of(folder / "old.igs"), "old");
}

TEST(OutputFile, AKilledProcessLeavesNothing) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "a.igs", "old");
  in_killed_process([&] {
    Result<OutputFile> file = OutputFile::create(folder / "a.igs");
    if (file && !file->write(std::string(1 << 20, 'x'))) ::_exit(1);
    ::kill(::getpid(), SIGKILL);  // with the file open
  });
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "old");
  const Names names = folder.names();
  EXPECT_EQ(names, Names{"a.igs"});
}

TEST(OutputFile, MakesMissingFolders) {
  const test::ScratchFolder folder;
  Result<OutputFile> file = OutputFile::create(folder / "a/b/c.igs");
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write("x").ok());
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(test::bytes_of(folder / "a/b/c.igs"), "x");
}

TEST(OutputFile, RefusesADirectory) {
  const test::ScratchFolder folder;
  std::filesystem::create_directory(folder / "out.igs");
  const Result<OutputFile> file = OutputFile::create(folder / "out.igs");
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().kind, Kind::io);
  EXPECT_EQ(file.error().file, (folder / "out.igs").string());
  EXPECT_NE(file.error().text.find("directory"), std::string::npos);
}

// A rename would put a file in the place of /dev/null, for everybody.
TEST(OutputFile, RefusesADeviceAndAPipe) {
  const test::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/null", folder / "null");
  for (const std::string name : {"pipe", "null"}) {
    const Result<OutputFile> file = OutputFile::create(folder / name);
    ASSERT_FALSE(file.ok()) << name;
    EXPECT_EQ(file.error().kind, Kind::io);
    EXPECT_EQ(file.error().file, (folder / name).string());
    EXPECT_NE(file.error().text.find("device or a pipe"), std::string::npos);
  }
  EXPECT_EQ(folder.names().size(), 2U);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "null"));
}

TEST(OutputFile, RefusesAFileInPlaceOfAFolder) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "a", "x");
  const Result<OutputFile> file = OutputFile::create(folder / "a/b.igs");
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().kind, Kind::io);
}

TEST(OutputFile, KeepsThePermissionsOfWhatItReplaces) {
  const test::ScratchFolder folder;
  put(folder / "a.igs", "old");
  for (const ::mode_t mode : {0640U, 0755U, 0444U}) {
    ASSERT_EQ(::chmod((folder / "a.igs").c_str(), mode), 0);
    put(folder / "a.igs", "new");
    EXPECT_EQ(facts_of(folder / "a.igs").st_mode & 0777U, mode);
  }
}

TEST(OutputFile, LeavesTheOldContentToOtherHardLinks) {
  const test::ScratchFolder folder;
  put(folder / "a.igs", "old");
  std::filesystem::create_hard_link(folder / "a.igs", folder / "kept.igs");
  put(folder / "a.igs", "new");
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "new");
  EXPECT_EQ(test::bytes_of(folder / "kept.igs"), "old");
}

TEST(OutputFile, ReplacesWhatALinkLeadsToAndNotTheLink) {
  const test::ScratchFolder folder;
  std::filesystem::create_directories(folder / "store");
  put(folder / "store/there.igs", "old");
  std::filesystem::create_symlink("store/there.igs", folder / "there.igs");
  std::filesystem::create_symlink("there.igs", folder / "twice.igs");
  std::filesystem::create_symlink("store/made.igs", folder / "made.igs");
  put(folder / "twice.igs", "new");
  put(folder / "made.igs", "made");
  EXPECT_EQ(test::bytes_of(folder / "store/there.igs"), "new");
  EXPECT_EQ(test::bytes_of(folder / "store/made.igs"), "made");
  for (const char* link : {"there.igs", "twice.igs", "made.igs"})
    EXPECT_TRUE(std::filesystem::is_symlink(folder / link)) << link;
  std::filesystem::create_symlink("circle.igs", folder / "circle.igs");
  const Result<OutputFile> circle = OutputFile::create(folder / "circle.igs");
  ASSERT_FALSE(circle.ok());
  EXPECT_EQ(circle.error().file, (folder / "circle.igs").string());
}

TEST(OutputFile, AnotherTargetMayBeInAnotherFolder) {
  const test::ScratchFolder folder;
  std::filesystem::create_directories(folder / "store");
  std::filesystem::create_symlink("store/a.igs", folder / "a.igs");
  Result<OutputFile> file = OutputFile::create(folder / "a.igs");
  ASSERT_TRUE(file.ok());
  const std::string bytes(3'000'000, 'z');
  ASSERT_TRUE(file->write(bytes).ok());
  ASSERT_TRUE(file->set_target(folder / "a.1.igs").ok());
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(test::bytes_of(folder / "a.1.igs"), bytes);
  EXPECT_FALSE(std::filesystem::exists(folder / "store/a.igs"));
}

// The folder of the last one goes when all are written: the others have their names by then.
TEST(OutputFile, SeveralAppearTogetherOrNotAtAll) {
  const test::ScratchFolder folder;
  put(folder / "replaced.igs", "old");
  for (const bool fails : {true, false}) {
    std::vector<OutputFile> files;
    for (const char* name : {"replaced.igs", "new.igs", "below/last.igs"}) {
      Result<OutputFile> file = OutputFile::create(folder / name);
      ASSERT_TRUE(file.ok());
      ASSERT_TRUE(file->write("new").ok());
      files.push_back(std::move(*file));
    }
    const std::vector<OutputFile*> all = {&files[0], &files[1], &files[2]};
    if (fails) std::filesystem::remove(folder / "below");
    const Status committed = OutputFile::commit(all);
    EXPECT_EQ(committed.ok(), !fails);
    files.clear();
    EXPECT_EQ(test::bytes_of(folder / "replaced.igs"), fails ? "old" : "new");
    EXPECT_EQ(folder.names(), fails ? Names{"replaced.igs"} : (Names{"below", "new.igs", "replaced.igs"}));
    EXPECT_EQ(fails ? committed.error().file : "", fails ? (folder / "below/last.igs").string() : "");
  }
  EXPECT_EQ(test::bytes_of(folder / "below/last.igs"), "new");
}

TEST(OutputFile, RemovesWhatNobodyHoldsAndNothingElse) {
  const test::ScratchFolder folder;
  const std::string left = ".selvage-0123456789abcdef.partial", held = ".selvage-fedcba9876543210.partial";
  const std::string own = ".a.igs.selvage-partial", likewise = ".selvage-mine.partial";
  for (const std::string& name : {left, held, own, likewise}) test::put_bytes(folder / name, "x");
  const int holder = ::open((folder / held).c_str(), O_RDWR);
  ASSERT_EQ(::flock(holder, LOCK_EX), 0);
  std::set<std::filesystem::path> folders;
  for (const char* name : {"a.igs", "b.igs", "nowhere/c.igs"})
    if (const auto hidden = OutputFile::hidden_folder(folder / name)) folders.insert(*hidden);
  EXPECT_EQ(folders.size(), 2);
  OutputFile::remove_leftovers(folders);
  EXPECT_EQ(folder.names(), (Names{own, held, likewise}));
  ::close(holder);
}

TEST(TemporaryFolder, GoesWithItsMakerOrAtTheNextOne) {
  const test::ScratchFolder place;
  const char* const old = std::getenv("TMPDIR");
  const std::string saved = old != nullptr ? old : "";
  ::setenv("TMPDIR", place.path().c_str(), 1);
  std::filesystem::create_directory(place / "selvage-scratch");  // somebody's own
  in_killed_process([] {
    if (const Result<TemporaryFolder> folder = TemporaryFolder::create(); folder.ok())
      ::kill(::getpid(), SIGKILL);
  });
  EXPECT_EQ(place.names().size(), 2U);
  {
    const Result<TemporaryFolder> first = TemporaryFolder::create();
    const Result<TemporaryFolder> second = TemporaryFolder::create();
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_EQ(place.names().size(), 3U);
    EXPECT_TRUE(std::filesystem::is_directory(first->path()));
  }
  EXPECT_EQ(place.names(), Names{"selvage-scratch"});
  if (old != nullptr)
    ::setenv("TMPDIR", saved.c_str(), 1);
  else
    ::unsetenv("TMPDIR");
}

// A limit on the size of files stands for the full disk: the same call fails at the same place.
TEST(OutputFile, AFullDiskIsAnErrorAndLeavesTheOldFile) {
  const test::ScratchFolder folder;
  test::put_bytes(folder / "a.igs", "old");
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1 << 16, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  {
    Result<OutputFile> file = OutputFile::create(folder / "a.igs");
    const Status first = file->write(std::string(1 << 15, 'x'));
    const Status second = file->write(std::string(1 << 20, 'y'));
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_TRUE(first.ok());
    ASSERT_FALSE(second.ok());
    EXPECT_EQ(second.error().kind, Kind::io);
    EXPECT_EQ(second.error().file, (folder / "a.igs").string());
  }
  EXPECT_EQ(folder.names(), Names{"a.igs"});
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "old");
}

TEST(OutputFile, WritesAnywhereAndReadsBack) {
  Result<OutputFile> file = OutputFile::in_memory();
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write("0123456789").ok());
  ASSERT_TRUE(file->write_at(2, "ab").ok());
  ASSERT_TRUE(file->write("!").ok());
  EXPECT_EQ(*file->contents(), "01ab456789!");
  ASSERT_TRUE(file->write_at(13, "x").ok());
  EXPECT_EQ(*file->contents(), std::string("01ab456789!\0\0x", 14));
  EXPECT_EQ(*file->read_at(2, 2), "ab");
  EXPECT_FALSE(file->read_at(10, 100).ok());
  ASSERT_TRUE(file->resize(3).ok());
  ASSERT_TRUE(file->write("?").ok());
  EXPECT_EQ(*file->contents(), "01a?");
}

TEST(OutputFile, MovesKeepTheBytes) {
  const test::ScratchFolder folder;
  Result<OutputFile> first = OutputFile::create(folder / "a.igs");
  ASSERT_TRUE(first.ok());
  ASSERT_TRUE(first->write("abc").ok());
  OutputFile second = std::move(*first);
  ASSERT_TRUE(second.write("def").ok());
  ASSERT_TRUE(second.commit().ok());
  EXPECT_EQ(test::bytes_of(folder / "a.igs"), "abcdef");
}

TEST(OutputFile, StandardOutputGetsTheBytesAtCommit) {
  const test::ScratchFolder folder;
  const int file = ::open((folder / "out").c_str(), O_CREAT | O_RDWR, 0600);
  std::fflush(stdout);
  const int saved = ::dup(STDOUT_FILENO);
  ASSERT_EQ(::dup2(file, STDOUT_FILENO), STDOUT_FILENO);
  const std::string bytes(3'000'000, 'z');
  Result<OutputFile> output = OutputFile::standard_output();
  const bool is_written = output.ok() && output->write(bytes).ok();
  struct stat before {};
  ::fstat(file, &before);
  const bool is_committed = is_written && output->commit().ok();
  ::dup2(saved, STDOUT_FILENO);
  ::close(saved);
  ::close(file);
  EXPECT_EQ(before.st_size, 0);
  EXPECT_TRUE(is_committed);
  EXPECT_EQ(test::bytes_of(folder / "out"), bytes);
}

}  // namespace selvage
