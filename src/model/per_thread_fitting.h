// SPDX-License-Identifier: BSD-3-Clause
//
// FCL cannot turn some volumes. For a discrete query of such a model it makes a copy and
// builds its tree in the query's pose. The copies share the fitter and the splitter of
// the model. FCL's own classes keep the state of a build in themselves, so that two
// threads that query one model would write to it at the same time. The classes here keep
// this state for each thread.
#ifndef FCL_CCD_MODEL_PER_THREAD_FITTING_H
#define FCL_CCD_MODEL_PER_THREAD_FITTING_H

#include "fcl/geometry/bvh/detail/BV_fitter.h"
#include "fcl/geometry/bvh/detail/BV_splitter.h"

namespace fcl {
namespace detail {

template <typename BV>
class PerThreadFitter : public BVFitterBase<BV> {
 public:
  using S = typename BV::S;

  virtual ~PerThreadFitter() = default;

  void set(Vector3<S>* vertices, Triangle* triangles, BVHModelType type) override {
    own().set(vertices, triangles, type);
  }
  void set(Vector3<S>* vertices, Vector3<S>* prev_vertices, Triangle* triangles,
           BVHModelType type) override {
    own().set(vertices, prev_vertices, triangles, type);
  }
  BV fit(unsigned int* primitives, int count) override {
    return own().fit(primitives, count);
  }
  void clear() override { own().clear(); }

 private:
  /// A thread builds one tree at a time.
  static BVFitter<BV>& own() {
    static thread_local BVFitter<BV> fitter;
    return fitter;
  }
};

template <typename BV>
class PerThreadSplitter : public BVSplitterBase<BV> {
 public:
  using S = typename BV::S;

  virtual ~PerThreadSplitter() = default;

  void set(Vector3<S>* vertices, Triangle* triangles, BVHModelType type) override {
    own().set(vertices, triangles, type);
  }
  void computeRule(const BV& bv, unsigned int* primitives, int count) override {
    own().computeRule(bv, primitives, count);
  }
  bool apply(const Vector3<S>& point) const override { return own().apply(point); }
  void clear() override { own().clear(); }

 private:
  static BVSplitter<BV>& own() {
    static thread_local BVSplitter<BV> splitter(SPLIT_METHOD_MEAN);
    return splitter;
  }
};

}  // namespace detail
}  // namespace fcl

#endif
