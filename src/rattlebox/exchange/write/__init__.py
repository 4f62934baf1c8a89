"""Writers: plain arrays as files of other programs."""
