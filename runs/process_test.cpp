#include "runs/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include "runs/run_directory.h"
#include "runs/temporary_folder.h"
#include "runs/test_variable.h"

using namespace flowrest::runs;
namespace fs = std::filesystem;

namespace {

using testing::HasSubstr;
using testing::Not;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whatever becomes of a test, nothing that wrote its number into a file named "deaf" outlives it.
class ProcessTest : public testing::Test {
 protected:
  ~ProcessTest() override {
    std::ifstream file(folder_ / "deaf");
    pid_t deaf = 0;
    std::error_code gone;
    if (file >> deaf && fs::equivalent("/proc/" + std::to_string(deaf) + "/cwd", folder_, gone))
      kill(deaf, SIGKILL);
  }
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

/// What is deaf to all that asks it to end; half a minute at most, where even the test is killed.
const std::string deaf_one =
    "/bin/sh -c \"trap '' INT TERM HUP; echo \\$\\$ > deaf; for i in \\$(seq 600); do sleep 0.05; done\"";

/// A shell that starts such a one in a session of its own, as mpirun starts ranks.
const std::vector<std::string> mother_of_a_deaf_one = {"-c", "setsid " + deaf_one + " & wait; sleep 60"};

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
    EXPECT_TRUE(mother.any_left()) << "its mother had gone before, by the first";
    usleep(800000);
    raise(SIGTERM);
    EXPECT_TRUE(mother.hand_on_interrupts());
  }
  EXPECT_FALSE(mother.any_left());
}

TEST_F(ProcessTest, AskedTwiceNothingIsLeftSecondsLater) {
  const InterruptGuard guard;
  Process mother("/bin/sh", mother_of_a_deaf_one, folder_, log(), {});
  ASSERT_GT(pid_in(folder_ / "deaf"), 0);
  for (int interrupt = 1; interrupt <= 2; ++interrupt) {
    usleep(800000);
    raise(SIGINT);
    mother.hand_on_interrupts();
  }
  const auto begin = std::chrono::steady_clock::now();
  while (mother.any_left() && std::chrono::steady_clock::now() - begin < std::chrono::seconds(20)) {
    mother.hand_on_interrupts();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_FALSE(mother.any_left());
}

TEST_F(ProcessTest, WhatAProcessLeavesBehindIsEnded) {
  Process mother("/bin/sh", {"-c", deaf_one + " & while [ ! -s deaf ]; do sleep 0.01; done; exit 0"}, folder_,
                 log(), {});
  ASSERT_TRUE(mother.wait(30.0));
  const pid_t deaf = pid_in(folder_ / "deaf");
  EXPECT_EQ(kill(deaf, 0), 0);
  mother.end_survivors(0.1);
  EXPECT_TRUE(ends(deaf));
}

TEST_F(ProcessTest, WhatAProcessLeavesBehindDoesNotOutliveIt) {
  pid_t deaf = 0;
  {
    Process mother("/bin/sh",
                   {"-c", "setsid " + deaf_one + " & while [ ! -s deaf ]; do sleep 0.01; done; exit 0"},
                   folder_, log(), Environment::of_helper());
    ASSERT_TRUE(mother.wait(30.0));
    deaf = pid_in(folder_ / "deaf");
    EXPECT_EQ(kill(deaf, 0), 0);
    EXPECT_TRUE(mother.any_left());
  }
  EXPECT_TRUE(ends(deaf));
}

TEST_F(ProcessTest, AHelperIsToldNothingOfItsUsersSettings) {
  const Variable settings[] = {{"FOAM_FILEHANDLER", "collated"},
                               {"WM_PROJECT_DIR", "/foreign"},
                               {"LD_LIBRARY_PATH", "/foreign"},
                               {"OMPI_MCA_btl", "tcp"},
                               {"GNUTERM", "dumb"},
                               {"PYTHONPATH", "/foreign"},
                               {"SNAKEMAKE_PROFILE", "mine"},
                               {"FFREPORT", "1"},
                               {"LC_NUMERIC", "de_DE.UTF-8"},
                               {"LANG", "de_DE.UTF-8"}};
  const Variable home("HOME", "/home/of/the/user"), slurm("SLURM_CONF", "/etc/slurm.conf");
  Process process("/usr/bin/env", {}, folder_, log(), Environment::of_helper().set("ADDED", "this"));
  ASSERT_TRUE(process.wait(30.0));
  const std::string told = text_of(log());
  for (const char* name :
       {"FOAM", "WM_", "LD_", "OMPI", "GNU", "PYTHON", "SNAKEMAKE", "FFREPORT", "de_DE", "/home/of"})
    EXPECT_THAT(told, Not(HasSubstr(name)));
  for (const char* line : {"LC_ALL=C.UTF-8\n", "ADDED=this\n", "SLURM_CONF=/etc/slurm.conf\n", "PATH="})
    EXPECT_THAT(told, HasSubstr(line));
  EXPECT_THAT(told, HasSubstr("PWD=" + folder_.string() + "\n"));
  Process own("/usr/bin/env", {}, folder_, log(), {{"ADDED", "this"}});
  ASSERT_TRUE(own.wait(30.0));
  EXPECT_THAT(text_of(log()), testing::AllOf(HasSubstr("ADDED=this\n"), HasSubstr("GNUTERM=dumb\n")));
}

TEST_F(ProcessTest, AHelpersHomeCanBeWrittenAndIsGoneWithIt) {
  const fs::path home = folder_ / "a home";
  Process process("/bin/sh", {"-c", "echo settings > $HOME/.rc"}, folder_, log(),
                  Environment::with_home(home));
  ASSERT_TRUE(process.wait(30.0));
  EXPECT_TRUE(process.poll()->good()) << text_of(log());
  const auto entries = Environment::of_helper().entries();
  EXPECT_TRUE(is_plain(entries.at("HOME")));
  EXPECT_EQ(entries.at("HOME"), entries.at("TMPDIR"));
  EXPECT_TRUE(fs::is_directory(entries.at("HOME")));
}

TEST_F(ProcessTest, EveryFolderHasAPlainName) {
  EXPECT_TRUE(is_plain("/tmp/run-1/case_2.0+a"));
  for (const char* path : {"case", "/tmp/a b", "/tmp/it's", "/tmp/$x", "/tmp/#1", "/tmp/a;b", "/tmp/{a}",
                           "/tmp/(a)", "/tmp/ö", "/tmp/a\nb", "/tmp/processor0/case"})
    EXPECT_FALSE(is_plain(path)) << path;
  EXPECT_FALSE(is_plain("/tmp/" + std::string(200, 'a')));
  const Variable place("TMPDIR", (folder_ / "a place").string());
  fs::create_directories(folder_ / "a place");
  for (const std::string& name : std::vector<std::string>{"a b", "it's \"#;{(ö$", "plain"}) {
    const fs::path folder = folder_ / name / "case";
    fs::create_directories(folder);
    std::ofstream(folder / "file") << name;
    const PlainName plain(folder);
    EXPECT_TRUE(is_plain(plain.path())) << plain.path();
    EXPECT_EQ(text_of(plain.path() / "file"), name);
    EXPECT_EQ(plain.path() == folder, name == "plain");
  }
  EXPECT_TRUE(fs::is_empty(folder_ / "a place"));
  EXPECT_EQ(TemporaryFolder().path().parent_path(), folder_ / "a place");
}

TEST_F(ProcessTest, ATemporaryFolderIsMadeWhereverOneCanBe) {
  const Variable place("TMPDIR", "/dev/null/none");
  EXPECT_TRUE(fs::is_directory(TemporaryFolder().path()));
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
