// SPDX-License-Identifier: BSD-3-Clause
#include "scene_method.h"

#include <stdexcept>
#include <utility>

#include "baselines/baseline.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "machine.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<>;

/// Above it feature boxes alone, which take several times as long as all others, are not
/// worth the time.
constexpr std::size_t kMostForFeatureBoxes = 1000000;

void expect(int code, const Model& model) {
  if (code != BVH_OK) throw std::runtime_error(model.lastError());
}

class LibraryMethod final : public SceneMethod {
 public:
  explicit LibraryMethod(ContinuousQuery query) {
    request_.query = query;
    request_.enable_contact = false;
  }

  void takeTopology(const FramePairMesh& frame) override { takeFrame(model_, frame); }

  FrameAnswer query(const FramePairMesh& frame) override {
    FrameAnswer answer;
    answer.ms = millisecondsOf([&] {
      updateFrames(model_, frame);
      continuousSelfCollide(&model_, request_, result_);
    });
    const StageCounts& counts = result_.counts;
    answer.feature_pairs = counts.feature_pairs - counts.box_culled;
    answer.elementary_tests = answer.feature_pairs - counts.filter_culled;
    answer.time_of_contact = result_.time_of_contact;
    for (const auto& contact : result_.contacts)
      answer.contacts.push_back(pairName(contact));
    return answer;
  }

 private:
  Model model_;
  ContinuousContactRequest<double> request_;
  ContinuousContactResult<double> result_;
};

class EarlierMethod final : public SceneMethod {
 public:
  explicit EarlierMethod(const BaselineMethod& method) : method_(method) {}

  void takeTopology(const FramePairMesh& frame) override {
    baseline_.reset();  // never two at a time: they are large
    baseline_ = makeBaseline(frame, method_);
  }

  void renew(const FramePairMesh& frame) override {
    std::unique_ptr<Baseline> fresh = makeBaseline(frame, method_);
    if (fresh->step(frame).total() < baseline_->step(frame).total())
      baseline_ = std::move(fresh);
  }

  FrameAnswer query(const FramePairMesh& frame) override {
    BaselineStep step = baseline_->step(frame);
    FrameAnswer answer;
    answer.ms = step.total();
    answer.feature_pairs = step.feature_pairs;
    answer.elementary_tests = step.elementary_tests;
    answer.contacts = std::move(step.contacts);
    return answer;
  }

 private:
  BaselineMethod method_;
  std::unique_ptr<Baseline> baseline_;
};

ListedMethod libraryMethod(const char* name, ContinuousQuery query) {
  return {name, "certified", libraryKernels(),
          [query] { return std::make_unique<LibraryMethod>(query); }};
}

}  // namespace

std::vector<ListedMethod> listMethods(std::size_t triangles) {
  std::vector<ListedMethod> methods{libraryMethod(kOurs, ContinuousQuery::kAll),
                                    libraryMethod(kOursFirst, ContinuousQuery::kFirst)};
  const auto add = [&](const char* name, Technique technique, const char* filter_name,
                       Filter filter, KernelSet kernels) {
    const BaselineMethod method{technique, filter, kernels};
    methods.push_back({name, filter_name,
                       kernels == KernelSet::kScalar ? "scalar" : "vector",
                       [method] { return std::make_unique<EarlierMethod>(method); }});
  };
  const struct {
    const char* name;
    Technique technique;
    bool has_vector_rows;
  } techniques[] = {{"feature boxes", Technique::kFeatureBoxes, false},
                    {"r-triangles", Technique::kRepresentatives, true},
                    {"iccd", Technique::kConnectivity, true}};
  for (const auto& t : techniques) {
    if (t.technique == Technique::kFeatureBoxes && triangles > kMostForFeatureBoxes)
      continue;
    add(t.name, t.technique, "none", Filter::kNone, KernelSet::kScalar);
    add(t.name, t.technique, "plain", Filter::kPlain, KernelSet::kScalar);
    if (!t.has_vector_rows) continue;
    add(t.name, t.technique, "none", Filter::kNone, KernelSet::kVector);
    add(t.name, t.technique, "plain", Filter::kPlain, KernelSet::kVector);
    add(t.name, t.technique, "certified", Filter::kCertified, KernelSet::kVector);
  }
  return methods;
}

void takeFrame(DeformableBVHModel<>& model, const FramePairMesh& frame) {
  if (model.isInStep()) {
    expect(model.updateTopology(frame.triangles, {}, frame.previous[0].data(),
                                frame.current[0].data(), frame.previous.size()),
           model);
    return;
  }
  expect(model.beginModel(static_cast<int>(frame.triangles.size()),
                          static_cast<int>(frame.previous.size())),
         model);
  expect(model.addSubModel(frame.previous, frame.triangles), model);
  expect(model.endModel(FclTree::kSkip), model);
}

void updateFrames(DeformableBVHModel<>& model, const FramePairMesh& frame) {
  expect(model.updateFrames(frame.previous[0].data(), frame.current[0].data(),
                            frame.previous.size(), FclTree::kSkip),
         model);
}

}  // namespace test
}  // namespace fcl
