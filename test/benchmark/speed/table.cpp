// SPDX-License-Identifier: BSD-3-Clause
#include "table.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "machine.h"
#include "number.h"

namespace fcl {
namespace test {
namespace {

std::string fields(const StepTimes& times) {
  return number(times.update) + ',' + number(times.traverse) + ',' + number(times.test) +
         ',' + number(times.total()) + ',';
}

std::string countOrDash(const std::optional<std::size_t>& count) {
  return count ? std::to_string(*count) : "-";
}

}  // namespace

void Hash::add(double number) {
  std::uint64_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  add(bits);
}

Hash hashOf(const std::vector<PairName>& sorted) {
  Hash hash;
  for (const PairName& pair : sorted)
    for (const int id : pair) hash.add(static_cast<std::uint64_t>(id));
  return hash;
}

void setContacts(std::vector<PairName>& found, const std::vector<PairName>& truth,
                 Row& row) {
  std::sort(found.begin(), found.end());
  row.contacts = found.size();
  const Errors errors = errorsOf(found, truth);
  row.missed = errors.missed;
  row.extra = errors.extra;
  row.hash = hashOf(found).value();
}

Table::Table(const std::string& folder, bool add) : machine_(machineName()) {
  std::filesystem::create_directories(folder);
  const auto mode = add ? std::ios::app : std::ios::trunc;
  rows_.open(folder + "/speed.csv", mode);
  sequences_.open(folder + "/speed_sequence.csv", mode);
  baselines_.open(folder + "/speed_baselines.csv", mode);
  options_.open(folder + "/speed_options.csv", mode);
  if (!rows_ || !sequences_ || !baselines_ || !options_)
    throw std::runtime_error(folder + ": cannot be written to");
  if (add) return;
  rows_ << "scene,triangles,query,boxes,filter,kernels,threads,ms_build,ms_update,"
           "ms_traverse,ms_test,ms_total,contacts,missed,extra,hash,peak_mb,machine\n";
  sequences_ << "sequence,frame,contacts,ms_update,ms_kept,ms_fresh_build,ms_fresh,ratio,"
                "ms_fresh_update,restructured,machine\n";
  baselines_ << "scene,triangles,technique,filter,kernels,ms_build,ms_update,ms_traverse,"
                "ms_test,ms_total,triangle_pairs,feature_pairs,elementary_tests,contacts,"
                "missed,extra,machine\n";
  options_ << "scene,triangles,option,query,ms_off,ms_on,ratio,contacts,missed,extra,"
              "machine\n";
}

void Table::add(const Row& row) {
  char hash[24];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(row.hash));
  rows_ << row.scene << ',' << row.triangles << ',' << row.query << ',' << row.boxes
        << ',' << row.filter << ',' << row.kernels << ',' << row.threads << ','
        << number(row.build) << ',' << fields(row.times) << row.contacts << ','
        << countOrDash(row.missed) << ',' << countOrDash(row.extra) << ',' << hash << ','
        << (row.peak_mb < 0 ? "-" : number(row.peak_mb, "%.0f")) << ',' << machine_
        << std::endl;
  std::fprintf(stderr, "%s: %s, %s boxes, %s filter, %s, %d threads: %.2f ms\n",
               row.scene.c_str(), row.query.c_str(), row.boxes.c_str(),
               row.filter.c_str(), row.kernels.c_str(), row.threads, row.times.total());
}

void Table::add(const SequenceRow& row) {
  const double kept = row.kept.traverse + row.kept.test;
  const double fresh = row.fresh.traverse + row.fresh.test;
  sequences_ << row.sequence << ',' << row.frame << ',' << row.contacts << ','
             << number(row.kept.update) << ',' << number(kept) << ','
             << number(row.fresh_build) << ',' << number(fresh) << ','
             << number(row.kept.total() / row.fresh.total()) << ','
             << number(row.fresh.update) << ',' << row.is_restructured << ',' << machine_
             << std::endl;
}

void Table::add(const BaselineRow& row) {
  baselines_ << row.scene << ',' << row.triangles << ',' << row.technique << ','
             << row.filter << ',' << row.kernels << ',' << number(row.build) << ','
             << fields(row.times) << row.triangle_pairs << ',' << row.feature_pairs << ','
             << row.elementary_tests << ',' << row.contacts << ',' << row.errors.missed
             << ',' << row.errors.extra << ',' << machine_ << std::endl;
  std::fprintf(stderr, "%s: %s, %s filter, %s: %.2f ms\n", row.scene.c_str(),
               row.technique.c_str(), row.filter.c_str(), row.kernels.c_str(),
               row.times.total());
}

void Table::add(const OptionRow& row) {
  options_ << row.scene << ',' << row.triangles << ',' << row.option << ',' << row.query
           << ',' << number(row.off) << ',' << number(row.on) << ','
           << number(row.on / row.off) << ',' << row.contacts << ',' << row.missed << ','
           << row.extra << ',' << machine_ << std::endl;
  std::fprintf(stderr, "%s: %s, %s: %.2f ms, %.2f without it\n", row.scene.c_str(),
               row.query.c_str(), row.option.c_str(), row.on, row.off);
}

void Table::finish() {
  if (!rows_.flush() || !sequences_.flush() || !baselines_.flush() || !options_.flush())
    throw std::runtime_error("the tables cannot be written");
}

}  // namespace test
}  // namespace fcl
