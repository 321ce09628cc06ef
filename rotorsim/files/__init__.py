"""Files from and for elsewhere: scenarios, and bearings and tables of other programs."""
