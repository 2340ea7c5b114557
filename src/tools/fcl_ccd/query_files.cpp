// SPDX-License-Identifier: BSD-3-Clause
#include "query_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "contact_text.h"
#include "counted.h"
#include "frame_list.h"
#include "mesh_io.h"
#include "truth_json.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;
using Kind = fcl::ContinuousContactKind;

struct KindName {
  std::string name;
  Kind kind;
};
const KindName kKindNames[] = {{"vf", Kind::kVertexFace},
                               {"vertex-face", Kind::kVertexFace},
                               {"ee", Kind::kEdgeEdge},
                               {"edge-edge", Kind::kEdgeEdge}};

/// Whether a name ends with a word: tree does not end with the word ee.
bool endsWithWord(const std::string& name, const std::string& word) {
  if (name.size() < word.size()) return false;
  const std::size_t begin = name.size() - word.size();
  return name.compare(begin, word.size(), word) == 0 &&
         (begin == 0 || std::isalpha(static_cast<unsigned char>(name[begin - 1])) == 0);
}

[[noreturn]] void refuseUnknownKind(const std::string& path) {
  throw std::runtime_error(path +
                           ": its name does not tell the kind of its queries. Give "
                           "--kind vf (vertex-face) or --kind ee (edge-edge)");
}

/// The CSV files of a folder and of those below.
std::vector<std::string> csvFilesOf(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (extensionOf(entry.path().string()) == "csv" && !entry.is_directory())
      paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end(), isBeforeNaturally);
  return paths;
}

/// Adds the truth of a file of answers.
void addAnswers(const QueryFile& file, QueryList& list) {
  const std::vector<bool> answers = readAnswers(file.answers);
  if (answers.size() != list.queries.size())
    throw std::runtime_error(file.answers + ": has " + counted(answers.size(), "answer") +
                             "; " + file.path + " has " +
                             std::to_string(list.queries.size()) + " queries");
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (list.has_truth && list.queries[i].truth != answers[i])
      throw std::runtime_error(file.answers + ": entry " + std::to_string(i) +
                               " differs from the truth in the rows of " + file.path);
    list.queries[i].truth = answers[i];
  }
  list.has_truth = true;
}

}  // namespace

std::optional<Kind> kindByName(const std::string& path) {
  std::string stem = fs::path(path).stem().string();
  if (isNamedAnswers(path)) stem.resize(stem.size() - kAnswersEnd.size());
  for (const KindName& entry : kKindNames)
    if (endsWithWord(stem, entry.name)) return entry.kind;
  const std::string folder = fs::path(path).parent_path().filename().string();
  for (const KindName& entry : kKindNames)
    if (folder == entry.name) return entry.kind;
  return std::nullopt;
}

std::vector<QueryFile> listQueryFiles(const std::vector<std::string>& words,
                                      std::optional<Kind> kind) {
  std::vector<QueryFile> files;
  for (const std::string& word : words) {
    std::error_code error;
    if (!fs::exists(word, error))
      throw std::runtime_error(word + ": cannot open: there is no such file or folder");
    if (!fs::is_directory(word, error)) {
      const std::optional<Kind> named = kind ? kind : kindByName(word);
      if (!named) refuseUnknownKind(word);
      files.push_back({word, *named});
      continue;
    }
    const std::size_t before = files.size();
    for (const std::string& path : csvFilesOf(word)) {
      const std::optional<Kind> named = kindByName(path);
      if (!named && !kind) refuseUnknownKind(path);
      const Kind found = named ? *named : *kind;
      if (!kind || found == *kind) files.push_back({path, found});
    }
    if (files.size() == before)
      throw std::runtime_error(
          word + ": the folder has no CSV file" +
          (kind ? std::string(" of kind ") + nameOf(*kind) : std::string(" of queries")));
  }
  return files;
}

QuerySet readQuerySet(std::vector<QueryFile> files) {
  QuerySet set;
  for (std::size_t i = 0; i < files.size(); ++i) {
    QueryList list = readQueries(files[i].path);
    if (!files[i].answers.empty()) addAnswers(files[i], list);
    if (i == 0) set.has_truth = list.has_truth;
    if (list.has_truth != set.has_truth)
      throw std::runtime_error(
          files[i].path + ": " + (list.has_truth ? "tells" : "does not tell") +
          " the truth, unlike " + files[0].path + ". Give it in all files or in none");
    set.queries.insert(set.queries.end(), list.queries.begin(), list.queries.end());
    set.file_of.resize(set.queries.size(), i);
  }
  set.files = std::move(files);
  return set;
}

std::size_t numQueriesNotDoubles(const QuerySet& set) {
  return static_cast<std::size_t>(
      std::count_if(set.queries.begin(), set.queries.end(),
                    [](const ElementaryQuery& query) { return query.exact != nullptr; }));
}

}  // namespace fcl_ccd
