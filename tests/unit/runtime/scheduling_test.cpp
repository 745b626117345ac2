// What the kernel is asked for, and what is said when it refuses.
#include "runtime/scheduling.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <string>
#include <thread>

#include "base/error.hpp"

namespace baton {
namespace {

TEST(Scheduling, ReadsCoresAndRefusesWhatIsNone) {
  EXPECT_EQ(parseCpus("0"), std::vector<int>{0});
  for (const char* bad : {"", "x", "-1", "0;1", "100000", "0,,0", " 0"}) {
    EXPECT_THROW((void)parseCpus(bad), UsageError) << bad;
  }
}

TEST(Scheduling, StaysOnTheCoresAskedFor) {
  std::thread([] {  // this thread alone, not the test's
    cpu_set_t set;
    ASSERT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
    std::size_t core = 0;  // the first of those that this process may use
    while (!CPU_ISSET(core, &set)) ++core;
    EXPECT_TRUE(applyScheduling({.cpus = std::to_string(core)}, false).empty());
    ASSERT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
    EXPECT_EQ(CPU_COUNT(&set), 1);
    EXPECT_TRUE(CPU_ISSET(core, &set));
  })
      .join();
}

TEST(Scheduling, GetsThePriorityOrSaysWhyNot) {
  std::thread([] {
    const std::vector<std::string> refusals = applyScheduling({.fifo_priority = 10, .cpus = {}}, true);
    if (refusals.empty()) {
      EXPECT_EQ(sched_getscheduler(0), SCHED_FIFO);
    } else {
      ASSERT_EQ(refusals.size(), 1U);
      EXPECT_NE(refusals.front().find("CAP_SYS_NICE"), std::string::npos) << refusals.front();
      EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER) << "a wish for real time is not a wish for batches";
    }
  }).join();
}

TEST(Scheduling, RunsInBatchesAndSoDoesWhatItStarts) {
  std::thread([] {
    EXPECT_TRUE(applyScheduling({}, true).empty());
    std::thread([] { EXPECT_EQ(sched_getscheduler(0), SCHED_BATCH); }).join();
  }).join();
}

TEST(Scheduling, AsksForNothingWhenNothingIsWanted) {
  EXPECT_TRUE(applyScheduling({}, false).empty());
  EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  EXPECT_TRUE(toArguments(Scheduling{}).empty());
  EXPECT_EQ(toArguments(Scheduling{.fifo_priority = 50, .cpus = "0"}),
            (std::vector<std::string>{"--fifo", "50", "--cpus", "0"}));
}

}  // namespace
}  // namespace baton
