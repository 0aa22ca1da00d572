// Chains: cullers in a row, each offered what the one before it kept.
#pragma once

#include <memory>
#include <vector>

#include "common/culler/culler.h"

namespace vislab {

/// A culler made of stages (at least two). Has the weakest guarantee and repeatability of its
/// stages and the finest granularity.
///
/// The link behind a stage collects what the stage emits and offers it to the next stage when the
/// stage returns or calls flush(), never once per emission: spans are kept, ids are not copied. A
/// stage of object granularity is offered objects only; the link puts the triangle ranges back on
/// what it keeps. Cost of a link: proportional to the number of spans emitted, plus, where ranges
/// meet a stage of object granularity, to the number of ranges.
std::unique_ptr<ICuller> make_chain(std::vector<std::unique_ptr<ICuller>> stages);

}  // namespace vislab
