// What    Fills the batch of a wave of ODPRT where every ray has a work-item: as raygen/admit.cl, of rays
//         that travel.
#define KDRAY_ODPRT 1
#include "raygen/admit.cl"
