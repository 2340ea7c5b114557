// SPDX-License-Identifier: BSD-3-Clause
//
// A query without and with an option of its request.
#ifndef FCL_BENCHMARK_SPEED_OPTION_QUERY_H
#define FCL_BENCHMARK_SPEED_OPTION_QUERY_H

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "rows.h"

namespace fcl {
namespace test {

/// @brief The objects of a query, and how it is asked.
class OptionQuery {
 public:
  using Request = ContinuousContactRequest<double>;
  using Result = ContinuousContactResult<double>;
  using Contact = ContinuousContact<double>;

  explicit OptionQuery(const SpeedScene& scene);

  Result operator()(const Request& request) const;

  /// @brief Times without and with an option, one after the other in each repeat.
  OptionRow measure(const std::string& option, const Request& off, const Request& on,
                    const Effort& effort) const;

  /// @brief The bounds of safeSelfDisplacements() beside a query, in the same way.
  OptionRow measureSafeDisplacements(const std::string& option, const Request& off,
                                     double max_displacement, double min_distance,
                                     const Effort& effort) const;

  std::vector<double> safeDisplacements(double max_displacement,
                                        double min_distance) const;

  /// @brief A request without options, for one thread.
  static Request request(ContinuousQuery query, double toc_err = 1e-4);

 private:
  using Model = DeformableBVHModel<>;

  static std::unique_ptr<Model> modelOf(const FramePairMesh& mesh);

  OptionRow measure(const std::string& option, const Request& off,
                    const std::function<void()>& on, const Effort& effort) const;

  std::string scene_;
  std::size_t triangles_;
  std::unique_ptr<Model> a_;
  std::unique_ptr<Model> b_{};
};

/// @brief Adds rows for contact of a mesh with itself at a distance, a tenth of its mean
/// edge. Errors are against pairs of features that come near, found without the library,
/// and those that touch.
void addDistances(const SpeedScene& scene, const OptionQuery& query, const Effort& effort,
                  std::vector<OptionRow>& rows);

}  // namespace test
}  // namespace fcl

#endif
