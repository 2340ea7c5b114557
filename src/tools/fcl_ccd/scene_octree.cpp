// SPDX-License-Identifier: BSD-3-Clause
#include "scene_octree.h"

#include <sstream>
#include <stdexcept>

#include "fcl/config.h"
#include "file_bytes.h"
#include "mesh_io.h"
#include "text_scan.h"

#if FCL_HAVE_OCTOMAP
#include "fcl/geometry/octree/octree.h"
#endif

namespace fcl_ccd {

#if FCL_HAVE_OCTOMAP
std::shared_ptr<fcl::CollisionGeometryd> readOctree(const std::string& path) {
  std::istringstream bytes(
      namingPlace([&] { return path; }, [&] { return readRegularFile(path); }));
  std::shared_ptr<octomap::OcTree> tree;
  if (extensionOf(path) == "bt") {
    constexpr double kAnyResolution = 1;  // the file has its own
    tree = std::make_shared<octomap::OcTree>(kAnyResolution);
    if (!tree->readBinary(bytes)) tree.reset();
  } else {
    const std::shared_ptr<octomap::AbstractOcTree> any(
        octomap::AbstractOcTree::read(bytes));
    tree = std::dynamic_pointer_cast<octomap::OcTree>(any);
    if (any && !tree)
      throw std::runtime_error(path + ": holds a tree of the type " + any->getTreeType() +
                               ". Save it as an OcTree");
  }
  if (!tree)
    throw std::runtime_error(path +
                             ": octomap cannot read this file. Save it again with "
                             "octomap: writeBinary() for .bt, write() for .ot");
  return std::make_shared<fcl::OcTreed>(tree);
}
#else
std::shared_ptr<fcl::CollisionGeometryd> readOctree(const std::string& path) {
  throw std::runtime_error(path +
                           ": this FCL was built without octomap, and has no "
                           "octrees");
}
#endif

}  // namespace fcl_ccd
