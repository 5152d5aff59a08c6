// ModelHandle: the way between the public Model and the view of it that tracing reads.
#pragma once

#include <memory>

#include "common/motion/model.h"
#include "mdk/model.h"

namespace mdk {

struct ModelHandle {
  /// `owner` holds the memory that the view points into; none: it outlives all copies.
  static Model make(const ModelView& view, std::shared_ptr<const void> owner = nullptr);
  /// Valid while a copy of the model lives.
  static const ModelView& view(const Model& model);
};

}  // namespace mdk
