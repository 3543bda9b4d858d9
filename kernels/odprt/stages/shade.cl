// What    Shades the hits of a wave of ODPRT where every ray has a work-item: as shade/shade.cl, of rays that
//         travel.
#define KDRAY_ODPRT 1
#include "shade/shade.cl"
