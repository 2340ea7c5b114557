# Not run: see ../README.md.
class FclCcd < Formula
  desc "Continuous collision detection of deforming meshes, as an extension of FCL"
  homepage "ADDRESS"
  url "ADDRESS/v0.3.0.tar.gz"
  sha256 "CHECKSUM"
  license "BSD-3-Clause"

  depends_on "boost" => :build
  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "nlohmann-json" => :build
  depends_on "eigen"
  depends_on "fcl"
  depends_on "highway"
  depends_on "libpng"
  depends_on "tbb"

  def install
    system "cmake", "-S", ".", "-B", "build", "-DBUILD_TESTING=OFF",
           "-DFCL_CCD_DOORS=nested",
           "-DFCL_CCD_BUILD_BENCHMARKS=OFF", "-DFCL_CCD_BUILD_PYTHON=OFF",
           "-DFCL_CCD_BUILD_MPI=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"fcl-ccd", "--version"
  end
end
