// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_SPEED_TABLE_H
#define FCL_BENCHMARK_SPEED_TABLE_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "effort.h"
#include "errors.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief FNV-1a, of 64 bits, over 64-bit words.
class Hash {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3u; }
  void add(double number);
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_{0xcbf29ce484222325u};
};

Hash hashOf(const std::vector<PairName>& sorted);

/// @brief Milliseconds of the stages of one step.
struct StepTimes {
  double update{0};
  double traverse{0};
  double test{0};

  double total() const { return update + traverse + test; }
};

/// @brief A row of speed.csv; doc/speed.md explains the columns.
struct Row {
  std::string scene;
  std::size_t triangles{0};
  std::string query;
  std::string boxes;
  std::string filter;
  std::string kernels;
  int threads{1};
  double build{0};
  StepTimes times{};
  std::size_t contacts{0};
  /// Nothing: not comparable.
  std::optional<std::size_t> missed{};
  std::optional<std::size_t> extra{};
  std::uint64_t hash{0};
  double peak_mb{-1};
};

/// @brief Sets the row's time of a build: the least that build() returns.
template <typename Build>
void measureBuild(const Effort& effort, Row& row, Build&& build) {
  row.build = std::numeric_limits<double>::infinity();
  repeat(effort, [&] { row.build = std::min(row.build, double{build()}); });
}

/// @brief Sets the row's times of a step: those of the repeat with the least total.
/// @param step  step(times) sets the times
template <typename Step>
void measureStep(const Effort& effort, Row& row, Step&& step) {
  bool first = true;
  repeat(effort, [&] {
    StepTimes times;
    step(times);
    if (first || times.total() < row.times.total()) row.times = times;
    first = false;
  });
}

/// @brief Sets number, errors and hash of the contacts, and sorts them.
void setContacts(std::vector<PairName>& found, const std::vector<PairName>& truth,
                 Row& row);

/// @brief A row of speed_baselines.csv; doc/baselines.md explains the columns.
struct BaselineRow {
  std::string scene;
  std::size_t triangles{0};
  std::string technique;
  std::string filter;
  std::string kernels;
  double build{0};
  StepTimes times{};
  std::size_t triangle_pairs{0};
  std::size_t feature_pairs{0};
  std::size_t elementary_tests{0};
  std::size_t contacts{0};
  Errors errors{};
};

/// @brief A row of speed_options.csv: a query without and with an option.
struct OptionRow {
  std::string scene;
  std::size_t triangles{0};
  std::string option;
  std::string query;
  double off{0};
  double on{0};
  std::size_t contacts{0};
  std::size_t missed{0};
  std::size_t extra{0};
};

/// @brief A row of speed_sequence.csv: a step from one frame to the next, with the tree
/// made for the first frame and with one made for this.
struct SequenceRow {
  std::string sequence;
  std::size_t frame{0};
  std::size_t contacts{0};
  std::uint64_t hash{0};
  double kept_build{0};
  double fresh_build{0};
  StepTimes kept;
  StepTimes fresh;
  /// Whether parts of the kept tree were made anew.
  bool is_restructured{false};
};

/// @brief speed.csv, speed_sequence.csv, speed_baselines.csv and speed_options.csv in a
/// folder.
class Table {
 public:
  /// @param add  to the files that are there
  /// @throws std::runtime_error if the files cannot be written
  Table(const std::string& folder, bool add);

  void add(const Row& row);
  void add(const SequenceRow& row);
  void add(const BaselineRow& row);
  void add(const OptionRow& row);

  /// @throws std::runtime_error if not everything could be written
  void finish();

 private:
  std::string machine_;
  std::ofstream rows_;
  std::ofstream sequences_;
  std::ofstream baselines_;
  std::ofstream options_;
};

}  // namespace test
}  // namespace fcl

#endif
