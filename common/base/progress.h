// ProgressSink: how long work tells whoever started it how far it is, and is told to stop.
#pragma once

#include <string_view>

namespace mdk {

class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  /// `fraction` in [0, 1] of the whole job; `stage` as shown to people ("decompose"). Called from
  /// one thread at a time. To cancel the job, throw from here.
  virtual void report(std::string_view stage, double fraction) = 0;
};

/// Takes no interest.
class SilentProgress final : public ProgressSink {
 public:
  void report(std::string_view, double) override {}
};

/// A part of a longer job: its 0 and 1 are `from` and `to` of the whole. The whole must outlive it.
class ProgressPart final : public ProgressSink {
 public:
  ProgressPart(ProgressSink& whole, double from, double to) : whole_(whole), from_(from), to_(to) {}
  void report(std::string_view stage, double fraction) override {
    whole_.report(stage, from_ + (to_ - from_) * fraction);
  }

 private:
  ProgressSink& whole_;
  double from_, to_;
};

}  // namespace mdk
