#include "runs/process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest::runs;
namespace fs = std::filesystem;

namespace {

class ProcessTest : public testing::Test {
 protected:
  fs::path log() const { return folder_ / "log"; }
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

}  // namespace

TEST_F(ProcessTest, SaysHowItEndedAndWithWhichWords) {
  Process shell("/bin/sh", {"-c", "echo first; echo 'flowrest: too fast'; echo; exit 3"}, folder_, log(), {});
  const auto end = shell.wait(30.0);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->how(), "exit code 3");
  EXPECT_EQ(last_words(log()), "too fast");
  Process killed("/bin/sh", {"-c", "kill -9 $$"}, folder_, log(), {});
  ASSERT_TRUE(killed.wait(30.0));
  EXPECT_EQ(killed.poll()->signal, SIGKILL);
  EXPECT_EQ(last_words(log()), "");
}

TEST_F(ProcessTest, AProgramThatCannotBeStartedIsNamedWithTheReason) {
  const auto why = [&](const fs::path& program, const fs::path& directory) -> std::string {
    try {
      Process process(program, {}, directory, log(), {});
    } catch (const MissingProgram& error) {
      return error.what();
    }
    return "it was started";
  };
  EXPECT_EQ(why("/nowhere/flowrest", folder_),
            "/nowhere/flowrest: cannot be started: No such file or directory");
  std::ofstream(folder_ / "text") << "not a program";
  EXPECT_EQ(why(folder_ / "text", folder_),
            (folder_ / "text").string() + ": cannot be started: Permission denied");
  EXPECT_EQ(why("/bin/sh", folder_ / "gone"), "/bin/sh: cannot be started: No such file or directory");
}
