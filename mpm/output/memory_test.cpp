// How much memory a whole run takes at its peak, a particle: that of a process of its own, as the system sees
// it.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

#include "mpm/output/run.h"
#include "mpm/output/test_runs.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_is_our_own = false;
#else
constexpr bool memory_is_our_own = true;
#endif

/// The most memory that `work` takes, in a process of its own; bytes.
double peak_of_process(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      work();
      _exit(0);
    } catch (...) {
      _exit(1);
    }
  }
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  EXPECT_EQ(status, 0);
  return 1024.0 * static_cast<double>(used.ru_maxrss);
}

class PeakMemory : public RunTest {
 protected:
  /// A whole slump in space that writes everything there is to write, over some steps.
  scenes::Scene whole_slump(double cell, const std::string& precision) const {
    return tiny_slump({"geometry.dimension=full", "mpm.particles_per_cell=8", "mpm.precision=" + precision,
                       "mpm.cell=" + std::to_string(cell), "time.end=" + std::to_string(0.4 * cell),
                       "output.history_interval=" + std::to_string(0.2 * cell),
                       "output.profile_interval=0.001", "output.snapshot_interval=0.001",
                       "output.checkpoint_interval=0.001"});
  }
  /// Bytes that the peak grows by for every particle more, from 45,000 to 160,000.
  double bytes_per_particle(const std::string& precision, bool resumed) const {
    std::vector<double> peak, particles;
    for (const double cell : {0.01, 0.0065}) {
      auto anew = options("run");
      anew.force = true;
      if (resumed) anew.interrupted = [asked = 0]() mutable { return asked++ == 4; };
      const double first = peak_of_process([&] { run(whole_slump(cell, precision), anew); });
      peak.push_back(resumed ? peak_of_process([&] { resume(options("run")); }) : first);
      const auto made = runs::read_run(folder / "run");
      EXPECT_EQ(made.status(), runs::Status::end_time);
      particles.push_back(made.info["particles"]);
    }
    return (peak[1] - peak[0]) / (particles[1] - particles[0]);
  }

  void expect_within_bounds(bool resumed) const {
    if (!memory_is_our_own) GTEST_SKIP() << "a sanitizer takes memory of its own";
    for (const auto& [precision, bound] : {std::pair{"float", 200.0}, std::pair{"double", 350.0}}) {
      const double bytes = bytes_per_particle(precision, resumed);
      std::printf("    %s: %.0f bytes a particle\n", precision, bytes);
      EXPECT_LE(bytes, bound) << precision;
    }
  }
};

}  // namespace

TEST_F(PeakMemory, OfAWholeRunIsThatOfItsParticlesAndGrid) { expect_within_bounds(false); }

TEST_F(PeakMemory, OfAResumedRunIsNoLarger) { expect_within_bounds(true); }
