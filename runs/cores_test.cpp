#include "runs/cores.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "runs/temporary_folder.h"

using namespace flowrest::runs;
namespace fs = std::filesystem;

namespace {

constexpr const char* variables[] = {"OMP_NUM_THREADS", "OMP_THREAD_LIMIT", "SLURM_CPUS_PER_TASK"};

/// Without any of the variables that say how many cores are ours.
class Cores : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* v : variables) unsetenv(v);
  }
  void TearDown() override { SetUp(); }
};

/// /proc and /sys as a machine with control groups shows them.
class Machine {
 public:
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((folder_.path() / file).parent_path());
    std::ofstream(folder_.path() / file) << text;
  }
  std::optional<double> quota() const { return core_quota(folder_.path()); }

 private:
  TemporaryFolder folder_;
};

class SecondVersion : public Machine {
 public:
  explicit SecondVersion(const std::string& group) {
    write("proc/self/cgroup", "0::" + group + "\n");
    write("proc/self/mountinfo",
          "22 27 0:21 / /proc rw - proc proc rw\n"
          "31 23 0:28 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate\n");
  }
};

}  // namespace

TEST_F(Cores, AreThoseOfTheAffinityMask) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int first = 0;
  while (!CPU_ISSET(first, &before)) ++first;
  int seen = 0;
  std::thread([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    sched_setaffinity(0, sizeof one, &one);
    seen = cores();
  }).join();
  EXPECT_EQ(seen, 1);
  EXPECT_GE(cores(), 1);
  EXPECT_LE(cores(), CPU_COUNT(&before));
}

TEST_F(Cores, VariablesTakeSomeAwayAndNeverAdd) {
  const int all = cores();
  for (const char* variable : variables) {
    setenv(variable, "1", 1);
    EXPECT_EQ(cores(), 1) << variable;
    setenv(variable, "100000", 1);
    EXPECT_EQ(cores(), all) << variable;
    for (const char* no_limit : {"", "0", "-3", "many", "1x", "1.5", " "}) {
      setenv(variable, no_limit, 1);
      EXPECT_EQ(cores(), all) << variable << " = '" << no_limit << "'";
    }
    unsetenv(variable);
  }
  setenv("OMP_NUM_THREADS", " 1 , 4", 1);
  EXPECT_EQ(cores(), 1) << "the first number is that of the outermost loops";
}

TEST(CoreQuota, IsTheGroupsOrThatOfOneThatHoldsIt) {
  const SecondVersion m("/user/job");
  EXPECT_EQ(m.quota(), std::nullopt) << "no such folder";
  m.write("sys/fs/cgroup/user/job/cpu.max", "max 100000\n");
  EXPECT_EQ(m.quota(), std::nullopt);
  m.write("sys/fs/cgroup/user/cpu.max", "250000 100000\n");
  EXPECT_EQ(m.quota(), 2.5);
  m.write("sys/fs/cgroup/user/job/cpu.max", "50000 100000\n");
  EXPECT_EQ(m.quota(), 0.5);
  m.write("sys/fs/cgroup/user/job/cpu.max", "400000 100000\n");
  EXPECT_EQ(m.quota(), 2.5);
}

TEST(CoreQuota, OfAContainerThatDoesNotKnowItsGroupsName) {
  const SecondVersion m("/docker/0123abcd");
  m.write("sys/fs/cgroup/cpu.max", "150000 100000\n");
  EXPECT_EQ(m.quota(), 1.5);
}

TEST(CoreQuota, OfTheFirstVersion) {
  const Machine m;
  m.write("proc/self/cgroup", "9:memory:/elsewhere\n3:cpuset:/elsewhere\n2:cpu,cpuacct:/outer/job\n0::/\n");
  m.write("proc/self/mountinfo",
          "32 31 0:29 /outer /sys/fs/cgroup/cpu,cpuacct rw - cgroup cgroup rw,cpu,cpuacct\n"
          "33 31 0:30 / /sys/fs/cgroup/cpuset rw - cgroup cgroup rw,cpuset\n");
  const std::string group = "sys/fs/cgroup/cpu,cpuacct/job/";
  m.write(group + "cpu.cfs_period_us", "100000\n");
  m.write(group + "cpu.cfs_quota_us", "-1\n");
  EXPECT_EQ(m.quota(), std::nullopt);
  m.write(group + "cpu.cfs_quota_us", "300000\n");
  EXPECT_EQ(m.quota(), 3.0);
  m.write("sys/fs/cgroup/cpuset/elsewhere/cpu.cfs_quota_us", "100000\n");
  m.write("sys/fs/cgroup/cpuset/elsewhere/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(m.quota(), 3.0) << "another hierarchy's";
}

TEST(CoreQuota, OfAMachineWithoutGroupsIsNone) { EXPECT_EQ(Machine().quota(), std::nullopt); }
