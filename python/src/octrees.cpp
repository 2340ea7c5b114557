// SPDX-License-Identifier: BSD-3-Clause
#include "octrees.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "arrays.h"
#include "classes.h"
#include "fcl/narrowphase/octree_cell.h"
#include "geometry.h"

#if !FCL_HAVE_OCTOMAP
#error "This FCL has no octrees. Build FCL with octomap, or set FCL_CCD_BUILD_PYTHON=OFF"
#endif

namespace fcl_ccd {
namespace python {
namespace {

/// A cell as an element of an array.
struct Cell {
  double center[3];
  double size;
};

}  // namespace

template <>
py::dtype makeDtype<Cell>() {
  return RecordType<Cell>()
      .field("center", "(3,)<f8", &Cell::center)
      .field("size", "<f8", &Cell::size)
      .dtype();
}

namespace {

/// octomap numbers the cells along an axis with 16 bits, and the origin is in the middle.
constexpr double kMostCells = 32768;

/// The cells that hold points are occupied, all others are unknown.
std::shared_ptr<const octomap::OcTree> makeMap(const Doubles& points, double resolution) {
  if (!(resolution > 0 && std::isfinite(resolution) && std::isnormal(1 / resolution)))
    throw py::value_error("resolution is " + std::to_string(resolution) +
                          ". Give the side of a cell, above 0");
  const auto map = std::make_shared<octomap::OcTree>(resolution);
  const double* x = points.data();
  for (py::ssize_t i = 0; i + 2 < points.size(); i += 3) {
    octomap::OcTreeKey key;
    const auto is_inside = [&](double c) {
      return std::abs(c) <= kMostCells * resolution;  // not for NaN
    };
    if (!std::all_of(x + i, x + i + 3, is_inside) ||
        !map->coordToKeyChecked(x[i], x[i + 1], x[i + 2], key))
      throw py::value_error("point " + std::to_string(i / 3) +
                            " is outside of the map, which has 32768 cells on each side "
                            "of the origin. Give larger cells, or move the points");
    // The same value for all, so that eight cells become one.
    map->setNodeValue(key, map->getClampingThresMaxLog(), true);
  }
  map->updateInnerOccupancy();
  map->prune();
  return map;
}

/// An octree. It never changes.
class OcTree : public Geometry {
 public:
  OcTree(const Doubles& points, double resolution)
      : map_(makeWithoutLock(points, resolution)), octree_(map_) {}

  const fcl::CollisionGeometry<double>& geometry() const override { return octree_; }
  double resolution() const { return map_->getResolution(); }
  std::size_t numCells() const { return map_->getRoot() ? map_->getNumLeafNodes() : 0; }

  /// @param numbers  of contacts
  py::array cells(const Integers& numbers) const {
    std::vector<Cell> cells;
    cells.reserve(static_cast<std::size_t>(numbers.size()));
    const std::int64_t* const begin = numbers.data();
    std::for_each(begin, begin + numbers.size(), [&](std::int64_t number) {
      const auto cell = fcl::octreeCell(octree_, static_cast<std::intptr_t>(number));
      cells.push_back({{cell.center[0], cell.center[1], cell.center[2]}, cell.size});
    });
    return toArray(std::move(cells));
  }

  /// The occupied cells, none of which was joined with others: their numbers along x, y
  /// and z, from the origin. Each of them had a point, so they are no more than these.
  Integers finestCells() const {
    std::vector<std::int64_t> numbers;
    const unsigned depth = map_->getTreeDepth();
    for (auto cell = map_->begin_leafs(), end = map_->end_leafs(); cell != end; ++cell) {
      const octomap::OcTreeKey first = cell.getIndexKey();
      const std::int64_t width = std::int64_t{1} << (depth - cell.getDepth());
      for (std::int64_t i = 0; i < width * width * width; ++i) {
        const std::int64_t in_cell[3] = {i / (width * width), i / width % width,
                                         i % width};
        for (int k = 0; k < 3; ++k)
          numbers.push_back(first[static_cast<unsigned>(k)] + in_cell[k] -
                            static_cast<std::int64_t>(kMostCells));
      }
    }
    Integers out({static_cast<py::ssize_t>(numbers.size() / 3), py::ssize_t{3}});
    std::copy(numbers.begin(), numbers.end(), out.mutable_data());
    return out;
  }

 private:
  static std::shared_ptr<const octomap::OcTree> makeWithoutLock(const Doubles& points,
                                                                double resolution) {
    const py::gil_scoped_release release;
    return makeMap(points, resolution);
  }

  std::shared_ptr<const octomap::OcTree> map_;
  fcl::OcTree<double> octree_;
};

}  // namespace

void bindOctrees(py::module_& module) {
  module.attr("octree_cell_dtype") = dtypeOf<Cell>();
  Class<OcTree, Geometry>(module, "OcTree")
      .defInit<const Doubles&, double>(py::arg("points"), py::arg("resolution"))
      .def_property_readonly("resolution", &OcTree::resolution)
      .def_property_readonly("num_cells", &OcTree::numCells)
      .def("_cells", &OcTree::cells)
      .def("_finest_cells", &OcTree::finestCells);
}

}  // namespace python
}  // namespace fcl_ccd
