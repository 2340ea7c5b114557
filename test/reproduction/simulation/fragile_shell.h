// SPDX-License-Identifier: BSD-3-Clause
//
// The surface of a brittle body: a wall between two layers, made of pieces that are
// bonded along their borders. When bonds break, pieces separate: a vertex on the crack
// becomes two or more, and the crack gets walls of its own, so that each part is closed.
#ifndef FCL_TEST_REPRODUCTION_FRAGILE_SHELL_H
#define FCL_TEST_REPRODUCTION_FRAGILE_SHELL_H

#include <cstddef>
#include <vector>

#include "fcl/common/types.h"
#include "fcl/math/triangle.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

/// @brief A sheet with positions of each vertex on both sides of the wall. Its pieces are
/// numbered from 0. Triangles are wound around the normal of the outer side.
struct ShellDesign {
  std::vector<Triangle> sheet;
  std::vector<Vector3<double>> outer, inner;  // metres
  std::vector<int> piece_of;                  // one a triangle of the sheet
};

/// @brief The change of a mesh's triangles. Ids of triangles and vertices that existed
/// stay.
struct TopologyChange {
  /// triangles with changed vertices, in ascending order; new triangles come after them
  std::vector<int> changed_triangles;
  std::size_t first_new_triangle{0};
  std::size_t first_new_vertex{0};
  /// for each new vertex, the vertex that it was split from
  std::vector<int> split_from;

  bool isEmpty() const { return changed_triangles.empty() && split_from.empty(); }
};

/// @brief The topology of a shell inside a larger mesh. The caller has the positions of
/// its vertices.
class FragileShell {
 public:
  /// @brief Two pieces with a common border.
  struct Bond {
    int piece_a, piece_b;
    Vector3<double> place;  // mean of the border's edges, as designed
    int edges;              // of the sheet
    double strength;        // N s, the caller's
    bool is_broken;
  };

  explicit FragileShell(ShellDesign design);

  /// @brief The whole shell as a closed mesh: first the vertices of the outer layer, then
  /// those of the inner one.
  TestMesh mesh() const;

  /// @brief Sets where mesh() is in a larger mesh.
  void place(int first_vertex, int first_triangle);

  int numPieces() const { return num_pieces_; }
  std::vector<Bond>& bonds() { return bonds_; }

  /// @brief For each piece the number (0, 1, ...) of its part. Unbroken bonds connect the
  /// pieces of a part.
  std::vector<int> findParts() const;

  /// @brief The vertices of each part.
  std::vector<std::vector<int>> verticesOf(const std::vector<int>& part_of_piece) const;

  /// @brief Splits the surface between pieces of different parts. Vertices on a crack
  /// move back from it by `gap` of the length of their edges, so that nothing touches.
  /// @param part_of_piece  the result of findParts()
  /// @param mesh, positions  are changed and extended. The positions are those of the
  /// mesh in a frame in which the parts still fit together
  void split(const std::vector<int>& part_of_piece, double gap,
             std::vector<Triangle>& triangles, std::vector<Vector3<double>>& positions,
             TopologyChange& change);

 private:
  struct Wall {
    int corner;  // where its edge begins
    int triangle;
  };
  struct VertexPair {
    int outer, inner;
  };

  int triangleOf(int corner) const { return corner / 3; }
  static int next(int corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  int sheetVertex(int corner) const {
    return static_cast<int>(sheet_[static_cast<std::size_t>(corner / 3)][corner % 3]);
  }
  void findNeighbours();
  void findBonds();
  std::vector<int> groupCorners(const std::vector<int>& part_of_piece) const;
  void drawBack(const std::vector<int>& group_of, const std::vector<char>& is_split,
                double gap, std::vector<Vector3<double>>& positions) const;
  void appendWall(int corner, std::vector<Triangle>& triangles) const;
  void setTriangles(std::vector<Triangle>& triangles, TopologyChange& change) const;
  std::vector<Triangle> wallOf(int corner) const;

  std::vector<Triangle> sheet_;
  std::vector<Vector3<double>> outer_, inner_;
  std::vector<int> piece_of_;
  int num_pieces_{0};
  int first_triangle_{0};
  std::vector<int> neighbour_;        // the corner on the edge's other side, or -1
  std::vector<VertexPair> vertices_;  // of each corner
  std::vector<Wall> walls_;
  std::vector<char> has_wall_;  // one a corner
  std::vector<Bond> bonds_;
};

}  // namespace test
}  // namespace fcl

#endif
