// SPDX-License-Identifier: BSD-3-Clause
//
// The renderer of the program, under the names of the tests.
#ifndef FCL_TEST_SUPPORT_PICTURES_H
#define FCL_TEST_SUPPORT_PICTURES_H

#include "image.h"
#include "mesh_generators.h"
#include "render.h"

namespace fcl {
namespace test {

using namespace fcl_ccd::picture;

inline Surface toSurface(const TestMesh& mesh) { return {mesh.vertices, mesh.triangles}; }

}  // namespace test
}  // namespace fcl

#endif
