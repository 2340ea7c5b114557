// SPDX-License-Identifier: BSD-3-Clause
//
// Speed beside error: every row of times carries the number of missed and of extra
// contacts. Usage: fcl_ccd_benchmark DATA_FOLDER [REPEATS]
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "motion_benchmark.h"
#include "planar_benchmark.h"
#include "rigid_benchmark.h"
#include "scene_benchmark.h"
#include "stock_benchmark.h"

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(
        stderr,
        "usage: %s DATA_FOLDER [REPEATS]\n"
        "DATA_FOLDER holds scenes/NAME/*.ply and scenes/NAME/true_pairs.csv.gz\n",
        argv[0]);
    return 2;
  }
  const std::string scenes = std::string(argv[1]) + "/scenes/";
  const int repeats = argc == 3 ? std::atoi(argv[2]) : 5;
  try {
    const fcl::test::SceneFiles cloth{"cloth-ball", scenes + "cloth-ball/", "92.ply",
                                      "93.ply"};
    const fcl::test::SceneFiles balls{"n-body", scenes + "n-body/", "18.ply", "19.ply"};
    fcl::test::printSceneHeader();
    for (const auto& files : {cloth, balls}) fcl::test::benchmarkScene(files, repeats);
    fcl::test::benchmarkPlanar(repeats);
    fcl::test::benchmarkRigid(repeats);
    fcl::test::benchmarkRigidTrees(repeats);
    fcl::test::benchmarkMotions(repeats);
    fcl::test::benchmarkAgainstStock(balls, repeats);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  return 0;
}
