// SPDX-License-Identifier: BSD-3-Clause
#include "truth_json.h"

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "file_bytes.h"
#include "json.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;
/// Calls take() for each entry of the array of a file.
template <typename Take>
void readArray(const std::string& path, Take take) {
  namingPlace([&] { return path; },
              [&] {
                Json array;
                try {
                  array = Json::parse(readBytes(path));
                } catch (const Json::parse_error& error) {
                  throw std::runtime_error(std::string("is not JSON: ") + error.what());
                }
                if (!array.is_array())
                  throw std::runtime_error("is not an array of JSON");
                for (std::size_t i = 0; i < array.size(); ++i)
                  namingPlace([&] { return "entry " + std::to_string(i); },
                              [&] { take(array[i]); });
              });
}

}  // namespace

bool isNamedAnswers(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  return stem.size() >= kAnswersEnd.size() &&
         stem.substr(stem.size() - kAnswersEnd.size()) == kAnswersEnd;
}

std::string answersBeside(const std::string& path) {
  const fs::path file(path), folder = file.parent_path();
  const std::string name = file.stem().string().append(kAnswersEnd) + ".json";
  std::error_code error;
  for (const fs::path& other : {folder / name, folder / ".." / "mma_bool" / name})
    if (fs::is_regular_file(other, error)) return other.lexically_normal().string();
  return "";
}

std::vector<bool> readAnswers(const std::string& path) {
  std::vector<bool> answers;
  readArray(path, [&](const Json& entry) {
    if (!entry.is_boolean())
      throw std::runtime_error(fcl_ccd::quoted(entry.dump()) + " is not true or false");
    answers.push_back(entry.get<bool>());
  });
  return answers;
}

std::vector<BoxPair> readBoxPairs(const std::string& path) {
  std::vector<BoxPair> pairs;
  readArray(path, [&](const Json& entry) {
    if (!entry.is_array() || entry.size() != 2 || !entry[0].is_number_integer() ||
        !entry[1].is_number_integer())
      throw std::runtime_error(fcl_ccd::quoted(entry.dump()) +
                               " is not a pair of whole numbers");
    pairs.push_back({entry[0].get<long long>(), entry[1].get<long long>()});
  });
  return pairs;
}

}  // namespace fcl_ccd
