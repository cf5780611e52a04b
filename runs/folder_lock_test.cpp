#include "runs/folder_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "runs/errors.h"
#include "runs/process.h"
#include "runs/temporary_folder.h"

using namespace flowrest::runs;
namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

class FolderLockTest : public testing::Test {
 protected:
  /// What somebody is told who wants the folder, too.
  std::string refusal() const {
    try {
      const FolderLock lock(folder_);
    } catch (const RunError& error) {
      return error.what();
    }
    return "it was free";
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_ / "run";
};

}  // namespace

TEST_F(FolderLockTest, TheSecondIsToldWhichProcessHoldsWhichFolder) {
  const FolderLock lock(folder_);
  EXPECT_EQ(refusal(), folder_.string() + ": process " + std::to_string(getpid()) +
                           " is writing here; wait for it, end it, or name another folder");
}

TEST_F(FolderLockTest, LeavesNothingBehind) {
  {
    const FolderLock lock(temporary_.path());
    EXPECT_EQ(refusal(), "it was free") << "a folder within is another folder";
    const FolderLock deeper(folder_ / "a" / "b");
    EXPECT_TRUE(fs::exists(folder_ / "a" / "b"));
  }
  EXPECT_TRUE(fs::is_empty(temporary_.path()));
  fs::create_directory(folder_);
  { const FolderLock lock(folder_); }
  EXPECT_TRUE(fs::is_directory(folder_)) << "a folder that was there stays";
  {
    const FolderLock lock(folder_ / "a" / "b");
    std::ofstream(folder_ / "a" / "note") << "mine";
  }
  EXPECT_TRUE(fs::exists(folder_ / "a" / "note"));
  EXPECT_FALSE(fs::exists(folder_ / "a" / "b"));
}

TEST_F(FolderLockTest, MovedItHoldsOn) {
  FolderLock lock(folder_);
  const FolderLock moved = std::move(lock);
  EXPECT_THAT(refusal(), HasSubstr("is writing here"));
}

TEST_F(FolderLockTest, DiesWithItsHolder) {
  const pid_t holder = fork();
  if (holder == 0) {
    const FolderLock lock(folder_);
    raise(SIGKILL);
  }
  ASSERT_EQ(waitpid(holder, nullptr, 0), holder);
  EXPECT_TRUE(fs::exists(folder_ / FolderLock::file_name)) << "nobody was left to tidy up";
  EXPECT_EQ(refusal(), "it was free");
  EXPECT_FALSE(fs::exists(folder_ / FolderLock::file_name));
}

TEST_F(FolderLockTest, ProgramsThatItsHolderStartedHoldItToo) {
  int word[2];
  ASSERT_EQ(pipe(word), 0);
  const pid_t holder = fork();
  if (holder == 0) {
    const FolderLock lock(folder_);
    if (fork() == 0) {
      close(word[1]);
      char ignored = 0;
      _exit(read(word[0], &ignored, 1) == 0 ? 0 : 1);  // lives until the test closes its end
    }
    raise(SIGKILL);
  }
  close(word[0]);
  ASSERT_EQ(waitpid(holder, nullptr, 0), holder);
  EXPECT_EQ(refusal(),
            folder_.string() + ": process " + std::to_string(holder) +
                " has ended, but programs that it started are still writing here; wait for it, end "
                "it, or name another folder");
  close(word[1]);
  for (int tries = 0; refusal() != "it was free" && tries < 1000; ++tries) usleep(10000);
  EXPECT_EQ(refusal(), "it was free");
}

TEST_F(FolderLockTest, AHolderOnAnotherMachineIsNamedWithIt) {
  const FolderLock lock(folder_);
  std::ofstream(folder_ / FolderLock::file_name) << "123 node7\n";
  EXPECT_THAT(refusal(), HasSubstr("process 123 on node7 is writing here"));
}
