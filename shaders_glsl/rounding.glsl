// The rasteriser decides on positions that it has rounded to a fraction of a pixel (SUBPIXELS): a coordinate moves by half
// a step, and by a little more in single precision.
#define MOST_ROUNDING (0.625 / float(SUBPIXELS))
