// SPDX-License-Identifier: BSD-3-Clause
//
// What is measured: the library's queries, the paper's method, earlier methods, the
// library over a sequence of frames.
#ifndef FCL_BENCHMARK_SPEED_ROWS_H
#define FCL_BENCHMARK_SPEED_ROWS_H

#include <string>
#include <vector>

#include "baselines/method.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "generated_scenes.h"
#include "scene_data.h"
#include "table.h"

namespace fcl {
namespace test {

/// @brief A self-collision, or one between two meshes.
struct SpeedScene {
  std::string name;
  FramePairMesh a;
  FramePairMesh b{};

  bool isSelf() const { return b.triangles.empty(); }
};

/// @brief What rows of the paper's method have as kernels: scalar code of its own, or the
/// library's.
constexpr const char* kPaperKernels = "scalar (paper)";
constexpr const char* kPaperVectorKernels = "vector (paper)";

/// @brief So many threads the library uses where all are allowed.
int allThreads();

/// @brief From here on the library's kernels are those that need no vector instructions,
/// if it has any. To be called before all else here, which chooses the kernels for the
/// process.
void useScalarKernels();

/// @brief A row for the library, without figures yet.
Row libraryRow(const std::string& scene, std::size_t triangles, ContinuousQuery query,
               int threads);

/// @brief Times of the library for one query, by its public functions; the least total of
/// the repeats. The model is built for the first frame and updated for each repeat.
/// @param threads  of builds, updates and queries
/// @param truth  sorted, or null for a row without errors; self-collisions only
/// @param found  if not null, gets the contacts of a self-collision, sorted
Row measureLibrary(const SpeedScene& scene, ContinuousQuery query, int threads,
                   const Effort& effort, const std::vector<PairName>* truth,
                   std::vector<PairName>* found = nullptr);

/// @brief Times of the library for all self-contacts, on one thread, with swept boxes in
/// its tree, by its inner functions.
Row measureSwept(const SpeedScene& scene, const Effort& effort,
                 const std::vector<PairName>& truth);

/// @brief Times of the paper's method for all self-contacts, on one thread.
/// @param boxes  "swept" (the paper's) or "moving"
/// @param filter  "none", "plain" (the paper's) or "certified"
/// @param kernels  scalar ones are the paper's
/// @throws std::invalid_argument for other words
Row measurePaper(const SpeedScene& scene, const std::string& boxes,
                 const std::string& filter, KernelSet kernels, const Effort& effort,
                 const std::vector<PairName>& truth);

/// @brief Times and counts of the methods of earlier papers for all self-contacts, with
/// and without a filter, scalar and with the library's kernels; on one thread.
std::vector<BaselineRow> measureBaselines(const SpeedScene& scene, const Effort& effort,
                                          const std::vector<PairName>& truth);

/// @brief Times of the library without and with each option of a request, on one thread,
/// and the errors of the answers with it; of two meshes only the tolerance. Errors are
/// against answers without the option, of which the rows know which ones are to stay, and
/// against answers found without the library (crossings, contact at a distance).
std::vector<OptionRow> measureOptions(const SpeedScene& scene, const Effort& effort);

/// @brief All self-contacts in every step of a sequence, with a model that is updated
/// from frame to frame, and with one that is built anew for each.
/// @throws std::logic_error if the two differ in their contacts
std::vector<SequenceRow> measureSequence(const std::string& name,
                                         const FrameSequence& sequence,
                                         const Effort& effort);

}  // namespace test
}  // namespace fcl

#endif
