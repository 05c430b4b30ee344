"""A rover without hardware: chassis, battery and sensors, stepped with dt. It knows no messages and no clock."""
