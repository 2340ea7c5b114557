// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "box_numbers.h"
#include "comparison.h"
#include "contact_text.h"
#include "counted.h"
#include "json.h"
#include "number_text.h"
#include "one_step.h"
#include "query_files.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;
using Kind = fcl::ContinuousContactKind;

/// The lists of one kind.
struct TruthFiles {
  Kind kind;
  std::string pairs;    ///< empty: this kind is not compared
  std::string answers;  ///< empty: not known
};

/// A pair of a list, and whether it touches, if this is known.
struct ListedPair {
  PairKey key;
  bool is_true{false};
};

/// The digits at the end of a file's name: 92 of cloth_ball92.ply.
std::string numberAtEnd(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  std::size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0)
    --begin;
  return stem.substr(begin);
}

/// The numbers of pairs of both lists, and what the library says of them.
struct FrameFigures {
  std::size_t listed{0};
  std::size_t candidates{0};  ///< of the library
  std::size_t found{0};       ///< listed pairs among the candidates
  std::size_t contacts{0};    ///< of the library
  bool has_answers{true};     ///< whether the next ones are known
  std::size_t num_true{0};
  std::size_t false_negatives{0};
  std::size_t false_positives{0};
};

bool has(const std::vector<PairKey>& sorted, const PairKey& key) {
  return std::binary_search(sorted.begin(), sorted.end(), key);
}

/// The keys of candidates or contacts of one kind, sorted.
template <typename Pair>
std::vector<PairKey> keysOf(const std::vector<Pair>& pairs, Kind kind) {
  std::vector<PairKey> keys;
  for (const Pair& pair : pairs) {
    const auto& v = pair.vertices;
    if (pair.kind == kind)
      keys.push_back(pairKey(kind, {v[0].id, v[1].id, v[2].id, v[3].id}));
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

class FrameComparison : public Comparison {
 public:
  explicit FrameComparison(const CompareOptions& options)
      : step_options_(stepOptions(options)), step_(step_options_) {
    if (options.truth.empty())
      findTruth();
    else
      for (const std::string& path : options.truth) takeTruth(path);
    for (TruthFiles& files : truth_) {
      if (options.kind && files.kind != *options.kind) files.pairs.clear();
      if (!files.pairs.empty() && files.answers.empty())
        files.answers = answersBeside(files.pairs);
    }
    if (truth_[0].pairs.empty() && truth_[1].pairs.empty())
      throw std::runtime_error(step_.files()[0] +
                               ": no list of pairs was found for these frames. Give "
                               "--truth FILES, such as 92vf.json and 92ee.json");
  }

  std::vector<std::string> files() const override {
    std::vector<std::string> names = step_.files();
    for (const TruthFiles& files : truth_)
      for (const std::string* path : {&files.pairs, &files.answers})
        if (!files.pairs.empty() && !path->empty()) names.push_back(*path);
    return names;
  }

  ComparisonRow run() override {
    step_.read();
    const BoxNumbers numbers(step_.inputs().a.firstVertices().size(),
                             step_.inputs().a.triangles());
    std::vector<ListedPair> lists[2];
    for (const std::size_t i : {0u, 1u}) lists[i] = readList(truth_[i], numbers);
    const std::vector<SceneCandidate> candidates = step_.candidates();
    const StepResult result = step_.query();
    FrameFigures figures;
    for (const std::size_t i : {0u, 1u})
      if (!truth_[i].pairs.empty())
        add(lists[i], truth_[i], candidates, result.contacts, figures);
    return report(figures, 1e3 * result.times.total());
  }

 private:
  static RunOptions stepOptions(const CompareOptions& options) {
    RunOptions step;
    step.frames = options.inputs;
    step.settings.toc_err = options.toc_err;
    step.settings.repeat = options.repeat;
    return step;
  }

  /// Takes the lists of Sample-Scalable-CCD-Data: frames/cloth_ball92.ply has
  /// boxes/92vf.json and boxes/92ee.json.
  void findTruth() {
    const fs::path frame = step_.files()[0];
    const fs::path folder = frame.parent_path() / ".." / "boxes";
    std::error_code error;
    for (TruthFiles& files : truth_) {
      const fs::path list = folder / (numberAtEnd(frame) + nameOf(files.kind) + ".json");
      if (fs::is_regular_file(list, error))
        files.pairs = list.lexically_normal().string();
    }
  }

  void takeTruth(const std::string& path) {
    const std::optional<Kind> kind = kindByName(path);
    if (!kind)
      throw std::runtime_error(
          path +
          ": its name does not tell the kind of its pairs. It has to "
          "end in vf or ee, as 92vf.json or 92ee_mma_bool.json");
    TruthFiles& files = truth_[*kind == Kind::kVertexFace ? 0 : 1];
    std::string& taken = isNamedAnswers(path) ? files.answers : files.pairs;
    if (!taken.empty())
      throw std::runtime_error(path + ": is for the same pairs as " + taken +
                               ". Compare one step at a time");
    taken = path;
  }

  static std::vector<ListedPair> readList(const TruthFiles& files,
                                          const BoxNumbers& numbers) {
    std::vector<ListedPair> list;
    if (files.pairs.empty()) return list;
    const std::vector<BoxPair> pairs = readBoxPairs(files.pairs);
    std::vector<bool> answers;
    if (!files.answers.empty()) {
      answers = readAnswers(files.answers);
      if (answers.size() != pairs.size())
        throw std::runtime_error(files.answers + ": has " +
                                 counted(answers.size(), "answer") + " to " +
                                 counted(pairs.size(), "pair") + " of " + files.pairs);
    }
    for (std::size_t i = 0; i < pairs.size(); ++i)
      namingPlace([&] { return files.pairs + ": entry " + std::to_string(i); },
                  [&] {
                    list.push_back({numbers.pairOf(files.kind, pairs[i]),
                                    !answers.empty() && answers[i]});
                  });
    return list;
  }

  static void add(const std::vector<ListedPair>& list, const TruthFiles& files,
                  const std::vector<SceneCandidate>& candidates,
                  const std::vector<SceneContact>& contacts, FrameFigures& figures) {
    const std::vector<PairKey> candidate_keys = keysOf(candidates, files.kind),
                               contact_keys = keysOf(contacts, files.kind);
    figures.listed += list.size();
    figures.candidates += candidate_keys.size();
    figures.contacts += contact_keys.size();
    if (files.answers.empty()) figures.has_answers = false;
    std::vector<PairKey> true_keys;
    for (const ListedPair& pair : list) {
      if (has(candidate_keys, pair.key)) ++figures.found;
      if (!pair.is_true) continue;
      true_keys.push_back(pair.key);
      ++figures.num_true;
      if (!has(contact_keys, pair.key)) ++figures.false_negatives;
    }
    std::sort(true_keys.begin(), true_keys.end());
    for (const PairKey& key : contact_keys)
      if (!has(true_keys, key)) ++figures.false_positives;
  }

  ComparisonRow report(const FrameFigures& figures, double ms) const {
    const auto text = [&](std::size_t count) {
      return figures.has_answers ? std::to_string(count) : "-";
    };
    const auto value = [&](std::size_t count) {
      return figures.has_answers ? Json(count) : Json(nullptr);
    };
    constexpr int kDigits = 4;
    const std::size_t missing = figures.listed - figures.found;
    return {{{"listed", std::to_string(figures.listed)},
             {"true", text(figures.num_true)},
             {"candidates", std::to_string(figures.candidates)},
             {"found", std::to_string(figures.found)},
             {"missing", std::to_string(missing)},
             {"contacts", std::to_string(figures.contacts)},
             {"FN", text(figures.false_negatives)},
             {"FP", text(figures.false_positives)},
             {"ms", numberText(ms, kDigits)}},
            {{"files", namesInJson(files())},
             {"listed", figures.listed},
             {"true", value(figures.num_true)},
             {"candidates", figures.candidates},
             {"found", figures.found},
             {"missing", missing},
             {"contacts", figures.contacts},
             {"false_negatives", value(figures.false_negatives)},
             {"false_positives", value(figures.false_positives)},
             {"ms", ms}}};
  }

  RunOptions step_options_;
  OneStep step_;
  TruthFiles truth_[2]{{Kind::kVertexFace, "", ""}, {Kind::kEdgeEdge, "", ""}};
};

}  // namespace

std::unique_ptr<Comparison> frameComparison(const CompareOptions& options) {
  return std::make_unique<FrameComparison>(options);
}

}  // namespace fcl_ccd
