// SPDX-License-Identifier: BSD-3-Clause
//
// Random scenes of objects of all kinds in a continuous manager.
#ifndef FCL_TEST_SUPPORT_MANAGER_SCENES_H
#define FCL_TEST_SUPPORT_MANAGER_SCENES_H

#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "moving_objects.h"
#include "test_models.h"

namespace fcl {
namespace test {

/// @brief The objects of a manager, in the order of their registration: meshes that are
/// rigid or deform, all shapes, octrees, a few planes and halfspaces, on motions of all
/// kinds. Half of the scenes have filters.
class ManagerScene {
 public:
  using Object = ContinuousCollisionObject<double>;

  /// @param flats  how many of 100 objects are tilted planes or halfspaces
  /// @param spacing  how far apart objects are: with 1 many of them meet
  ManagerScene(Random& random, std::size_t count, std::size_t flats = 0,
               double spacing = 1);

  /// @brief The next step: some objects go, some come, some have another geometry or
  /// motion, and the cloth has another frame.
  void change();

  /// @brief The filter of an object; of one without, the default.
  const ContinuousFilter& filterOf(const Object* object) const;

  /// @brief Gives a thickness to half of the objects, and to some pairs a distance.
  void addThickness(bool with_pairs);
  /// @brief What two objects add to the distance of a query.
  double distanceOf(const Object* o1, const Object* o2) const;

  ContinuousCollisionManager<double> manager;
  /// Whether all paths are straight.
  bool is_straight;
  std::vector<Object*> objects;
  std::map<const Object*, ContinuousFilter> filters;
  std::map<const Object*, double> thickness;
  /// The lower address first.
  std::map<std::pair<const Object*, const Object*>, double> pair_distances;

 private:
  using Deformable = DeformableBVHModel<KDOP<double, 16>>;

  TestMesh clothFrame();
  std::shared_ptr<MotionBase<double>> randomMotion();
  Object* make(bool is_cloth);
  void setFilter(Object* object);

  Random& random_;
  double size_;
  std::size_t flats_;
  bool has_filters_;
  std::shared_ptr<Deformable> cloth_;
  std::vector<std::unique_ptr<Object>> owned_;
};

}  // namespace test
}  // namespace fcl

#endif
