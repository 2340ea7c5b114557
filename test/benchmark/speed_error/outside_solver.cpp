// SPDX-License-Identifier: BSD-3-Clause
#include "outside_solver.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace fcl {
namespace test {
namespace {

namespace fs = std::filesystem;

/// A file that is gone with the object.
class QueryFile {
 public:
  explicit QueryFile(const QuerySet& set)
      : path_(fs::temp_directory_path() /
              ("fcl_ccd_queries_" + std::to_string(getpid()) + "_" + set.name + ".csv")) {
    std::ofstream out(path_);
    out << "# index,kind,24 coordinates: x,y,z of four points at t = 0, then at t = 1\n";
    out.precision(17);
    for (std::size_t i = 0; i < set.queries.size(); ++i) {
      const MovingPair& query = set.queries[i];
      out << i << (query.kind == fcl::ContinuousContactKind::kVertexFace ? ",vf" : ",ee");
      for (const auto& p : query.x) write(out, p.t0);
      for (const auto& p : query.x) write(out, p.t1);
      out << '\n';
    }
    if (!out.flush()) throw std::runtime_error(path_.string() + ": cannot be written");
  }
  ~QueryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  QueryFile(const QueryFile&) = delete;
  QueryFile& operator=(const QueryFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  static void write(std::ofstream& out, const double (&point)[3]) {
    for (const double x : point) out << ',' << x;
  }

  fs::path path_;
};

/// What a command prints.
std::string outputOf(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot be run");
  std::string text;
  char buffer[1 << 16];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    text.append(buffer, n);
  if (pclose(pipe) != 0) throw std::runtime_error("the program failed");
  return text;
}

class AnswerReader {
 public:
  explicit AnswerReader(std::size_t count)
      : answers_(count), is_answered_(count, false) {}

  void read(const std::string& text) {
    std::size_t line_no = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      ++line_no;
      const std::string line = text.substr(begin, end - begin);
      if (!line.empty() && line[0] != '#' && !readLine(line.c_str()))
        throw std::runtime_error(
            "line " + std::to_string(line_no) +
            " of its output is not the answer to an open query: " + line);
      begin = end + 1;
    }
    if (num_answered_ != answers_.size())
      throw std::runtime_error("it answered " + std::to_string(num_answered_) + " of " +
                               std::to_string(answers_.size()) + " queries");
  }

  const std::vector<MethodAnswer>& answers() const { return answers_; }
  double nsMean() const { return ns_mean_; }

 private:
  bool readLine(const char* line) {
    if (std::sscanf(line, "ns_mean,%lf", &ns_mean_) == 1) return true;
    std::size_t index = 0;
    int answer = 0;
    double toc = 0;
    const int fields = std::sscanf(line, "%zu,%d,%lf", &index, &answer, &toc);
    const bool is_complete = (fields >= 2 && answer == 0) ||
                             (fields == 3 && answer == 1 && toc >= 0 && toc <= 1);
    if (!is_complete || index >= answers_.size() || is_answered_[index]) return false;
    is_answered_[index] = true;
    ++num_answered_;
    answers_[index] = {answer == 1, toc, 0};
    return true;
  }

  std::vector<MethodAnswer> answers_;
  std::vector<bool> is_answered_;
  std::size_t num_answered_{0};
  double ns_mean_{-1};
};

}  // namespace

OutsideSolver parseOutsideSolver(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw std::runtime_error(text + ": expected NAME=COMMAND");
  OutsideSolver solver{text.substr(0, equals), text.substr(equals + 1)};
  if (solver.name.find_first_of(",\"\n ") != std::string::npos)
    throw std::runtime_error(solver.name + ": a name has no comma, quote or blank");
  return solver;
}

OutsideAnswers runOutsideSolver(const OutsideSolver& solver, const QuerySet& set) {
  const QueryFile file(set);
  AnswerReader reader(set.queries.size());
  double seconds = 0;
  try {
    const auto start = std::chrono::steady_clock::now();
    const std::string text = outputOf(solver.command + " '" + file.path() + "'");
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    seconds = taken.count();
    reader.read(text);
  } catch (const std::exception& error) {
    throw std::runtime_error("solver " + solver.name + ", set " + set.name + ": " +
                             error.what());
  }
  const bool own_clock = reader.nsMean() >= 0;
  return {reader.answers(),
          own_clock ? reader.nsMean()
                    : 1e9 * seconds / static_cast<double>(set.queries.size()),
          own_clock};
}

}  // namespace test
}  // namespace fcl
