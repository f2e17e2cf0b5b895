// Loops over fixed pieces, the clock of serial work, jobs beside the steps, trees searched in pieces.
#include "solver/base/bvh.hpp"
#include "solver/base/phase_clock.hpp"
#include "solver/explicit/run/background_work.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <stdexcept>
#include <tbb/global_control.h>

namespace iga::solve {
namespace {

tbb::global_control limit(std::size_t threads) {
  return {tbb::global_control::max_allowed_parallelism, threads};
}

TEST(Parallel, PiecesDoNotDependOnThreadsAndCoverAll) {
  for (const std::size_t threads : {1, 3}) {
    const auto control = limit(threads);
    for (const std::size_t count : {0, 1, 99, 100, 101, 1000}) {
      std::vector<int> visits(count, 0);
      std::vector<std::size_t> first_of(num_chunks(count, 100), count);
      for_chunks(count, 100, [&](std::size_t c, std::size_t first, std::size_t last) {
        first_of[c] = first;
        for (std::size_t i = first; i < last; ++i) ++visits[i];
      });
      EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](int n) { return n == 1; }));
      for (std::size_t c = 0; c < first_of.size(); ++c) EXPECT_EQ(first_of[c], 100 * c);
    }
  }
}

double spin(double seconds) {
  double sum = 0;
  for (const double begin = thread_cpu_seconds(); thread_cpu_seconds() - begin < seconds;) sum += 1;
  return sum;
}

// On one thread what lies inside of loops and outside of them is told apart, loops within loops counted once.
TEST(PhaseClock, TellsSerialWorkFromParallelLoops) {
  const auto control = limit(1);
  PhaseClock clock;
  clock.measure_cpu();
  clock.restart();
  spin(0.02);
  for_indices(10, 1, [](std::size_t) { for_indices(2, 1, [](std::size_t) { spin(0.002); }); });
  clock.lap(Phase::Nodes);
  spin(0.01);
  clock.lap(Phase::Output);
  ParallelTime::measure(false);
  const auto of = [&](Phase phase) { return clock.times()[static_cast<std::size_t>(phase)]; };
  EXPECT_NEAR(of(Phase::Nodes).cpu, 0.06, 0.005);
  EXPECT_NEAR(of(Phase::Nodes).serial, 0.02, 0.003);
  EXPECT_NEAR(of(Phase::Output).serial, 0.01, 0.002);
  EXPECT_GE(of(Phase::Nodes).wall, of(Phase::Nodes).cpu * 0.99);
  EXPECT_EQ(of(Phase::Search).wall, 0);
  EXPECT_NEAR(clock.total().cpu, 0.07, 0.006);
}

TEST(BackgroundWork, KeepsTheOrderAndWaits) {
  for (const std::size_t threads : {1, 3}) {
    const auto control = limit(threads);
    std::vector<int> done;
    BackgroundWork work;
    for (int i = 0; i < 20; ++i) work.add([&done, i] { done.push_back(i); });
    work.wait();
    EXPECT_TRUE(work.is_idle());
    std::vector<int> expected(20);
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(done, expected);
  }
}

TEST(BackgroundWork, WhatAJobThrowsComesOutAndLaterJobsAreDropped) {
  const auto control = limit(2);
  int done = 0;
  BackgroundWork work;
  const auto failing = [&] {
    work.add([] { throw std::runtime_error("disk full"); });
    work.add([&done] { ++done; }); // dropped, or refused where the first one has failed by now
    work.wait();
  };
  EXPECT_THROW(failing(), std::runtime_error);
  EXPECT_EQ(done, 0);
  work.add([&done] { ++done; }); // said once
  work.wait();
  EXPECT_EQ(done, 1);
}

TEST(Bvh, PartsHoldTheSamePairsAsTheWholeAndFitInParallel) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 10);
  const auto boxes = [&](std::size_t n) {
    std::vector<Box3> all(n);
    for (Box3& box : all) {
      for (std::size_t d = 0; d < 3; ++d) box.lower[d] = place(random);
      for (std::size_t d = 0; d < 3; ++d) box.upper[d] = box.lower[d] + 0.1;
    }
    return all;
  };
  const auto first = boxes(3000), second = boxes(1700), moved = boxes(3000);
  Bvh a(first);
  const Bvh b(second);
  a.refit(moved);
  const auto never = [](const Box3&, const Box3&) { return false; };
  using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;
  Pairs whole, pieces, expected;
  a.each_close_pair(b, 0.2, never, [&](std::int32_t i, std::int32_t j) { whole.emplace_back(i, j); });
  const auto parts = a.close_parts(b, 0.2, never, 100);
  EXPECT_GE(parts.size(), 100);
  for (const Bvh::PartPair& part : parts)
    a.each_close_pair(part, b, 0.2, never, [&](std::int32_t i, std::int32_t j) { pieces.emplace_back(i, j); });
  for (std::size_t i = 0; i < moved.size(); ++i)
    for (std::size_t j = 0; j < second.size(); ++j)
      if (overlap(grown(moved[i], 0.2), second[j]))
        expected.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
  for (Pairs* pairs : {&whole, &pieces}) std::sort(pairs->begin(), pairs->end());
  EXPECT_EQ(whole, expected);
  EXPECT_EQ(pieces, expected);
}

} // namespace
} // namespace iga::solve
