// SPDX-License-Identifier: BSD-3-Clause
//
// Other forms of scenes of one or two moving meshes, whose contacts follow from those of
// the first form. A scene has a mesh `a` and an optional one `b`.
#ifndef FCL_TEST_SUPPORT_MESH_FORMS_H
#define FCL_TEST_SUPPORT_MESH_FORMS_H

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "moving_mesh.h"

namespace fcl {
namespace test {

/// @brief The scene after visit(mesh) for each mesh.
template <typename Scene, typename Visit>
Scene changed(Scene scene, Visit&& visit) {
  visit(scene.a);
  if (scene.b) visit(*scene.b);
  return scene;
}

/// @brief The scene with map(position) in place of each position.
template <typename Scene, typename Map>
Scene mappedScene(const Scene& scene, Map&& map) {
  return changed(scene, [&map](MovingMesh& mesh) {
    for (auto* frame : {&mesh.t0, &mesh.t1})
      for (auto& p : *frame) p = map(p);
  });
}

template <typename T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[random.index(i)]);
}

/// @brief Gives the vertices of a mesh new ids.
/// @return the old id of each
inline std::vector<int> renumber(MovingMesh& mesh, Random& random) {
  const MovingMesh old = mesh;
  std::vector<int> old_ids(mesh.t0.size());
  std::iota(old_ids.begin(), old_ids.end(), 0);
  shuffle(old_ids, random);
  std::vector<std::size_t> new_ids(old_ids.size());
  for (std::size_t i = 0; i < old_ids.size(); ++i) {
    const auto from = static_cast<std::size_t>(old_ids[i]);
    new_ids[from] = i;
    mesh.t0[i] = old.t0[from];
    mesh.t1[i] = old.t1[from];
  }
  for (Triangle& t : mesh.triangles) t = {new_ids[t[0]], new_ids[t[1]], new_ids[t[2]]};
  return old_ids;
}

}  // namespace test
}  // namespace fcl

#endif
