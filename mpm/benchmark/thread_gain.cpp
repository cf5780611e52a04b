#include "mpm/benchmark/thread_gain.h"

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "mpm/benchmark/turns.h"

namespace flowrest::mpm::bench {

namespace {

constexpr int turns = 15;
constexpr int busy_loops = 2;
constexpr double particle_steps_per_turn = 1e6;

/// Cores that this process may use.
std::vector<int> cores() {
  cpu_set_t all;
  CPU_ZERO(&all);
  std::vector<int> found;
  if (sched_getaffinity(0, sizeof all, &all) != 0) return found;
  for (int c = 0; c < CPU_SETSIZE; ++c)
    if (CPU_ISSET(c, &all)) found.push_back(c);
  return found;
}

/// Keeps the calling thread, and those it starts from then on, on some cores.
void stay_on(const std::vector<int>& some) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int c : some) CPU_SET(c, &set);
  sched_setaffinity(0, sizeof set, &set);
}

/// A core's speed is its own, above all in a virtual machine: one thread is measured on each of them in turn.
void print_gain(const char* name, const std::vector<std::string>& set, const std::vector<int>& all) {
  const auto threads = static_cast<double>(all.size());
  const auto time_of = [](FlowingSlump& slump) {
    const int steps = std::max(1, static_cast<int>(particle_steps_per_turn / slump.particles()));
    return time_of_steps(slump, steps, wall_seconds);
  };
  FlowingSlump one(set), together(with(set, {"mpm.threads=" + std::to_string(all.size())}));
  for (const int core : all) {  // until everything is in its place
    stay_on({core});
    time_of(one);
  }
  stay_on(all);
  time_of(together);
  const StageTimes one_before = one.solver().stage_times(), before = together.solver().stage_times();
  std::vector<double> alone, both, gain;
  for (int turn = 0; turn < turns; ++turn) {
    double speed = 0.0;
    for (const int core : all) {
      stay_on({core});
      speed += 1.0 / time_of(one);
    }
    alone.push_back(threads / speed);
    stay_on(all);
    both.push_back(time_of(together));
    gain.push_back(alone.back() / both.back());
  }
  std::printf("  %-32s %6.1f ns %6.1f ns  x %.2f (%.2f to %.2f)", name, quantile(alone, 0.5),
              quantile(both, 0.5), quantile(gain, 0.5), quantile(gain, 0.25), quantile(gain, 0.75));
  const auto stage = [&](const char* what, double StageTimes::*s) {
    const double of_one = (one.solver().stage_times().*s - one_before.*s) / threads,
                 of_all = together.solver().stage_times().*s - before.*s;
    if (of_one > 0.0) std::printf("  %s %.2f", what, of_one / of_all);
  };
  stage("to grid", &StageTimes::particles_to_grid);
  stage("nodes", &StageTimes::nodes);
  stage("back", &StageTimes::grid_to_particles);
  stage("sorting", &StageTimes::sorting);
  stage("volumes", &StageTimes::volumes);
  std::printf("\n");
  std::fflush(stdout);
}

/// Other people's work: processes that always have something to do, for as long as this lives.
class BusyLoops {
 public:
  explicit BusyLoops(int count) {
    for (int i = 0; i < count; ++i) {
      const pid_t child = fork();
      if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        while (true) benchmark::ClobberMemory();
      }
      if (child > 0) children_.push_back(child);
    }
  }
  ~BusyLoops() {
    for (const pid_t child : children_) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
  }
  BusyLoops(const BusyLoops&) = delete;
  BusyLoops& operator=(const BusyLoops&) = delete;

 private:
  std::vector<pid_t> children_;
};

/// Wall and CPU time of a particle-step, ns.
struct Times {
  double wall = 0.0, cpu = 0.0;
};

Times times_of(FlowingSlump& slump, double particle_steps) {
  const int steps = std::max(1, static_cast<int>(particle_steps / slump.particles()));
  const double cpu = cpu_seconds(), wall = time_of_steps(slump, steps, wall_seconds);
  return {wall, (cpu_seconds() - cpu) / (steps * slump.particles()) * 1e9};
}

/// What all threads take of one's time beside other work, wherever the system puts them.
void print_cost_beside_others(const char* name, const std::vector<std::string>& set, std::size_t threads) {
  FlowingSlump one(set), together(with(set, {"mpm.threads=" + std::to_string(threads)}));
  const BusyLoops others(busy_loops);
  std::vector<double> wall, cpu, wall_ratio, cpu_ratio;
  for (int turn = 0; turn < turns; ++turn) {
    const Times alone = times_of(one, particle_steps_per_turn),
                all = times_of(together, particle_steps_per_turn);
    wall.push_back(alone.wall);
    cpu.push_back(alone.cpu);
    wall_ratio.push_back(all.wall / alone.wall);
    cpu_ratio.push_back(all.cpu / alone.cpu);
  }
  const auto print = [](const char* what, const std::vector<double>& one_takes,
                        const std::vector<double>& ratio) {
    std::printf("  %s %6.1f ns x %.2f (%.2f to %.2f)", what, quantile(one_takes, 0.5), quantile(ratio, 0.5),
                quantile(ratio, 0.25), quantile(ratio, 0.75));
  };
  std::printf("  %-32s", name);
  print("wall", wall, wall_ratio);
  print("CPU", cpu, cpu_ratio);
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

void print_thread_gain() {
  const std::vector<int> all = cores();
  if (all.size() < 2) {
    std::printf("There is one core here: nothing to gain\n");
    return;
  }
  std::printf(
      "what %zu threads gain: wall time of a particle-step on one core (the mean of all) and on all of them\n"
      "(medians of %d turns; quartiles of the gain), and the gain of every stage\n",
      all.size(), turns);
  for (const auto& [size, base] : {std::pair{"44k", quarter_44k()}, std::pair{"1M", quarter_1m()}})
    for (const char* scheme : {"quadratic-apic", "linear-flip"})
      for (const char* precision : {"float", "double"})
        print_gain(
            (std::string(size) + "/" + scheme + "/" + precision).c_str(),
            with(base, {std::string("mpm.scheme=") + scheme, std::string("mpm.precision=") + precision}),
            all);
  stay_on(all);
  std::printf(
      "what they cost beside %d busy loops: wall and CPU time of a particle-step on one thread, and times "
      "that on "
      "all of them\n(medians of %d turns; quartiles of the ratio)\n",
      busy_loops, turns);
  for (const char* scheme : {"quadratic-apic", "linear-flip"})
    for (const char* precision : {"float", "double"})
      print_cost_beside_others((std::string("44k/") + scheme + "/" + precision).c_str(),
                               with(quarter_44k(), {std::string("mpm.scheme=") + scheme,
                                                    std::string("mpm.precision=") + precision}),
                               all.size());
}

}  // namespace flowrest::mpm::bench
