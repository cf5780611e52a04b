#include "runs/process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
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

/// The process whose number a file holds, once it does; waits for the whole line.
pid_t pid_in(const fs::path& path) {
  for (int tries = 0; tries < 3000; ++tries) {
    std::ifstream file(path);
    if (std::string line; std::getline(file, line) && !file.eof()) return std::atoi(line.c_str());
    usleep(10000);
  }
  return 0;
}

/// Whether a process is gone, or soon is.
bool ends(pid_t pid) {
  for (int tries = 0; tries < 3000; ++tries) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string text;
    if (!std::getline(file, text) || text.find(") Z ") != std::string::npos) return true;
    usleep(10000);
  }
  return false;
}

/// A shell that starts another, deaf to all that asks it to end and in a session of its own, as mpirun starts
/// ranks.
const std::vector<std::string> mother_of_a_deaf_one = {
    "-c",
    "setsid /bin/sh -c \"trap '' INT TERM HUP; echo \\$\\$ > deaf; while :; do sleep 0.05; done\" & wait; "
    "sleep 60"};

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

TEST_F(ProcessTest, WhenItIsKilledNobodyItStartedIsLeft) {
  pid_t deaf = 0;
  {
    Process mother("/bin/sh", mother_of_a_deaf_one, folder_, log(), {});
    deaf = pid_in(folder_ / "deaf");
    ASSERT_GT(deaf, 0);
  }
  EXPECT_TRUE(ends(deaf));
}

TEST_F(ProcessTest, TheThirdInterruptEndsEverything) {
  const InterruptGuard guard;
  Process mother("/bin/sh", mother_of_a_deaf_one, folder_, log(), {});
  const pid_t deaf = pid_in(folder_ / "deaf");
  ASSERT_GT(deaf, 0);
  EXPECT_FALSE(mother.hand_on_interrupts());
  for (int interrupt = 1; interrupt <= 3; ++interrupt) {
    usleep(800000);
    raise(SIGTERM);
    EXPECT_TRUE(mother.hand_on_interrupts());
  }
  EXPECT_TRUE(ends(deaf)) << "its mother had gone before, by the first";
}

TEST_F(ProcessTest, WhatAProcessLeavesBehindIsEnded) {
  Process mother("/bin/sh",
                 {"-c",
                  "/bin/sh -c \"trap '' INT TERM HUP; echo \\$\\$ > deaf; while :; do sleep 0.05; done\" & "
                  "while [ ! -s deaf ]; do sleep 0.01; done; exit 0"},
                 folder_, log(), {});
  ASSERT_TRUE(mother.wait(30.0));
  const pid_t deaf = pid_in(folder_ / "deaf");
  EXPECT_EQ(kill(deaf, 0), 0);
  mother.end_survivors(0.1);
  EXPECT_TRUE(ends(deaf));
}

TEST(InterruptGuardTest, NotesWhateverAsksToStopOnceWhereItComesTogether) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU, SIGUSR1}) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;  // in the background, say
    const InterruptGuard guard;
    {
      const InterruptGuard nested;
      raise(number);
    }
    EXPECT_EQ(InterruptGuard::count(), 1) << strsignal(number);
    raise(SIGTERM);
    raise(number);
    EXPECT_EQ(InterruptGuard::count(), 1) << strsignal(number);
    usleep(800000);
    raise(SIGPIPE);
    if (number == SIGPIPE) {
      EXPECT_EQ(InterruptGuard::count(), 1) << "every further word would bring it again";
    }
  }
  signal(SIGPIPE, SIG_DFL);
}

TEST(InterruptGuardTest, WhatTheCallerIgnoresStaysIgnored) {
  for (const int number : {SIGINT, SIGHUP}) {
    const auto before = signal(number, SIG_IGN);
    {
      const InterruptGuard guard;
      raise(number);
      EXPECT_EQ(InterruptGuard::count(), 0);
    }
    raise(number);  // and after it
    signal(number, before);
  }
}
