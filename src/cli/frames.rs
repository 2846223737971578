//! Frames of `octagloss query --frames`: a normal, a view and a tangent each, which may be missing.

use super::rows::Kind;
use anyhow::anyhow;
use glam::DVec3;
use octagloss_core::common::frame::Frame;

pub(super) const FRAMES: Kind<Frame> = Kind {
    columns: &["nx", "ny", "nz", "vx", "vy", "vz", "tx", "ty", "tz"],
    required: 6,
    plural: "frames",
    parse: |values| {
        let vector = |k: usize| DVec3::new(values[k], values[k + 1], values[k + 2]);
        let tangent = if values.len() == 9 { vector(6) } else { DVec3::ZERO };
        Frame::new(vector(0), vector(3), tangent)
            .ok_or_else(|| anyhow!("the normal or the view is 0,0,0, which is not a direction"))
    },
};

#[cfg(test)]
mod tests {
    use super::super::rows::LIMITS;
    use super::FRAMES;

    #[test]
    fn rows_are_frames_and_faults_are_named() {
        let read = FRAMES.read_from(&b"nx,ny,nz,vx,vy,vz\n0,1,0, 0,2,2\n"[..], LIMITS).expect("a frame");
        assert!(!read.is_full && read.typed[0] == "0,1,0,0,2,2");
        assert!((read.values[0].view.z - 0.5_f64.sqrt()).abs() < 1e-15, "n.v");
        for (text, words) in [
            ("", "empty; the first line must be nx,ny,nz,vx,vy,vz"),
            (
                "x,y,z\n",
                "line 1 is \"x,y,z\"; the header must be nx,ny,nz,vx,vy,vz or nx,ny,nz,vx,vy,vz,tx,ty,tz",
            ),
            ("nx,ny,nz,vx,vy,vz\n1,2\n", "line 2 has 2 values; its header has 6"),
            ("nx,ny,nz,vx,vy,vz\n1,2,3,4,5,a\n", "line 2: vz is \"a\", not a number"),
            ("nx,ny,nz,vx,vy,vz\n1,2,3,4,5,inf\n", "line 2: vz is inf; it must be finite"),
            (
                "nx,ny,nz,vx,vy,vz\n0,0,0,4,5,6\n",
                "line 2: the normal or the view is 0,0,0, which is not a direction",
            ),
        ] {
            let error = format!("{:#}", FRAMES.read_from(text.as_bytes(), LIMITS).err().expect("a fault"));
            assert_eq!(error, words);
        }
    }
}
