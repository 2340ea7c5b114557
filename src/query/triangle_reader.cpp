// SPDX-License-Identifier: BSD-3-Clause
#include "query/triangle_reader.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "base/error.h"
#include "mesh/non_finite_vertex.h"
#include "tree/bent_boxes.h"
#include "tree/box_position.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

bool isFinite(const TreeVertex& x) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += 0 * x.t0[k] + 0 * x.t1[k];
  return sum == 0;
}

}  // namespace

TriangleReader::TriangleReader(const MeshInstance& mesh) : mesh_(mesh) {
  if (!mesh.isInPlace()) return;
  in_place_ = {mesh.tree->triangles().data(), mesh.tree->vertices().data()};
}

/// Sets the slot of a triangle.
void TriangleReader::find(int i) {
  assert(i >= 0);
  if (!triangles_) {
    // Not initialized, since each is written before it is read.
    triangles_.reset(new TreeTriangle[kSlots]);
    vertices_.reset(new TreeVertex[3 * kSlots]);
    stored_.assign(kSlots, -1);
    slot_of_.assign(kSlots, 0);
    slot_of_vertex_.assign(kSlots, 0);
  }
  std::uint16_t& slot = slot_of_[static_cast<std::size_t>(i) % kSlots];
  const std::size_t reads_left = (slot + kSlots - next_) % kSlots;
  if (stored_[slot] != i || reads_left < kStored) {
    stored_[next_] = -1;
    compute(i, next_);
    stored_[next_] = i;
    slot = static_cast<std::uint16_t>(next_);
    next_ = (next_ + 1) % kSlots;
  }
  index_ = i;
  slot_ = slot;
}

void TriangleReader::compute(int i, std::size_t slot) {
  const auto index = static_cast<std::size_t>(i);
  assert(slot < kSlots && (!mesh_.tree || index < mesh_.tree->triangles().size()));
  TreeTriangle& triangle = triangles_[slot];
  if (mesh_.tree) {
    triangle = mesh_.tree->triangles()[index];
  } else {
    triangle.index = static_cast<std::uint32_t>(i);
    triangle.owned = kOwnsAll;
    if (mesh_.owners) {
      std::copy(mesh_.owners[index].v, mesh_.owners[index].v + 3, triangle.id);
      triangle.owned = mesh_.owners[index].owned;
    } else {
      for (int k = 0; k < 3; ++k) {
        const std::size_t id = mesh_.triangles.id(index, k);
        if (id >= mesh_.frames.size())
          throwBadInput(std::string(mesh_.name) + ": triangle " + std::to_string(i) +
                        " refers to a vertex that is not there. The model has " +
                        std::to_string(mesh_.frames.size()) + ", numbered from 0");
        triangle.id[k] = static_cast<std::uint32_t>(id);
      }
      // As in assignFeatures(), an edge with two equal ids is not a feature.
      for (unsigned k = 0; k < 3; ++k)
        if (triangle.id[k] == triangle.id[(k + 1) % 3])
          triangle.owned &= ~(1U << (3 + k));
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t id = triangle.id[k];
    TreeVertex& x = vertices_[3 * slot + k];
    std::uint16_t& slot_of_vertex = slot_of_vertex_[id % kSlots];
    if (!mesh_.tree && isStored(id, slot_of_vertex)) {
      x = vertices_[slot_of_vertex];
    } else {
      pose(id, x);
      if (mesh_.tree) x.box = mesh_.tree->vertices()[triangle.place[k]].box;
      if (!isFinite(x)) throw NonFiniteVertex(mesh_.name, id);
    }
    slot_of_vertex = static_cast<std::uint16_t>(3 * slot + k);
  }
}

/// Whether the vertex in a slot of the store has this id.
bool TriangleReader::isStored(std::uint32_t id, std::size_t slot) const {
  assert(slot < 3 * kSlots);
  return stored_[slot / 3] >= 0 && triangles_[slot / 3].id[slot % 3] == id;
}

void TriangleReader::pose(std::uint32_t id, TreeVertex& out) const {
  assert(id < mesh_.frames.size());
  const VertexPath path = mesh_.frames[id];
  out.setPath(path.t0, path.t1);
  assert(!(mesh_.bend && mesh_.tree));
  if (mesh_.tree) return;
  // The boxes of a rigid tree do not contain the translation, so that it is subtracted
  // here. Adding and subtracting it each round by 2^-53 of the numbers, and so do the
  // difference to the origin and a sum. Together this is less than 2^-50 of `size`. The
  // pad is twice that, since roundUp() may lose a part of it to rounding.
  const auto fit = [&](const double* x, int frame, Kdop16& box) {
    const double(&translation)[3] = mesh_.translation[frame];
    const double(&origin)[3] = mesh_.rigid.origin(frame);
    double p[3], size = 0;
    for (int k = 0; k < 3; ++k) {
      p[k] = x[k] - translation[k];
      size =
          std::max(size, std::abs(x[k]) + std::abs(translation[k]) + std::abs(origin[k]));
    }
    fitPoint(p, origin, roundUp(size * 0x1p-49, 0.f), box);
  };
  fit(out.t0, 0, out.box.t0);
  fit(out.t1, 1, out.box.t1);
  if (mesh_.bend) enlarge(*mesh_.bend, out);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
