// SPDX-License-Identifier: BSD-3-Clause
//
// The methods of table1.csv, behind one call a frame.
#ifndef FCL_BENCHMARK_PAPER_SCENE_METHOD_H
#define FCL_BENCHMARK_PAPER_SCENE_METHOD_H

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief What a method says of a frame, and what it took.
struct FrameAnswer {
  /// Update, traversal and tests.
  double ms{std::numeric_limits<double>::infinity()};
  /// What a filter is asked: pairs of features whose boxes overlap.
  std::size_t feature_pairs{0};
  /// What the solver is asked.
  std::size_t elementary_tests{0};
  std::vector<PairName> contacts;
  /// Of the library only: the methods of the papers list pairs.
  double time_of_contact{1};
};

/// @brief A method that keeps what it has from frame to frame.
class SceneMethod {
 public:
  virtual ~SceneMethod() = default;

  /// @brief Takes in a frame whose topology is not that of the frame before.
  virtual void takeTopology(const FramePairMesh& frame) = 0;

  /// @brief Goes on with a structure made for this frame, if it is faster than the one
  /// that was kept. Methods that look after their structure by themselves have nothing to
  /// do.
  virtual void renew(const FramePairMesh&) {}

  virtual FrameAnswer query(const FramePairMesh& frame) = 0;
};

/// @brief A method as the tables name it.
struct ListedMethod {
  std::string name;
  std::string filter;
  std::string kernels;
  std::function<std::unique_ptr<SceneMethod>()> make;

  bool is(const char* a_name, const char* a_filter, const char* a_kernels) const {
    return name == a_name && filter == a_filter && kernels == a_kernels;
  }
};

/// @brief As the tables name the library: all contacts, and the first one.
constexpr const char* kOurs = "ours";
constexpr const char* kOursFirst = "ours (first)";

/// @brief The library, all contacts before the first, then the methods of the papers.
/// @param triangles  of the scene: of a large one feature boxes alone, several times
/// slower than all others, are not measured
std::vector<ListedMethod> listMethods(std::size_t triangles);

/// @brief Gives a model a frame whose topology is not the model's.
/// @throws std::runtime_error if the model refuses it
void takeFrame(DeformableBVHModel<>& model, const FramePairMesh& frame);

/// @brief Gives a model both frames of the topology that it has.
/// @throws std::runtime_error if the model refuses them
void updateFrames(DeformableBVHModel<>& model, const FramePairMesh& frame);

}  // namespace test
}  // namespace fcl

#endif
